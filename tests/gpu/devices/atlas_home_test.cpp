// Densities in a buffer, read by its address, and in images (SHVR_ATLAS): the same bits, and the same work.

#include <algorithm>
#include <cstdlib>
#include <string>

#include <doctest/doctest.h>

#include "tests/gpu/matrix/feature_list.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Devices that are opened while it lives keep densities there.
class Home {
public:
    explicit Home(const char* name) { setenv("SHVR_ATLAS", name, 1); }
    Home(const Home&) = delete;
    ~Home() { unsetenv("SHVR_ATLAS"); }
};

bool is_in_buffer(const FrameGraph& graph)
{
    const auto atlas = std::ranges::find(graph.resources(), "atlas", &FrameGraph::ResourceData::name);
    REQUIRE(atlas != graph.resources().end());
    return atlas->desc.kind == ResourceDesc::Kind::buffer;
}

/// The counters of all passes.
std::vector<uint64_t> work_of(const Picture& picture)
{
    std::vector<uint64_t> work;
    for (const gpu::PassReport& pass : picture.passes)
        work.insert(work.end(), pass.counters.begin(), pass.counters.end());
    return work;
}

struct PicturesAtHome {
    std::vector<Picture> pictures;
    std::optional<Renderer::Seen> seen;
};

/// Noise of one type in a scene under a budget, painted by a brush; `Paging::always` has bricks come and go.
PicturesAtHome pictures_at(const char* home, VoxelType type, Paging paging)
{
    const Home there(home);
    Renderer renderer({.device = {.validation = true}, .threads = 1});
    TestVolume volume = noise_volume({77, 45, 70}, 5);
    volume.type = type;
    if (type == VoxelType::uint8) {
        for (double& voxel : volume.voxels) voxel = double(int(voxel) >> 8);
        volume.maximum = 255.0;
    }
    Session session = plain_session(busy_points(0.3), {40, 30});
    if (type == VoxelType::uint8)
        session.transfer_function = TransferFunction({{120.0, RED, 0.0}, {140.0, BLUE, 0.05}, {255.0, WHITE, 0.3}});
    session.light.shaded = true;
    session.render.paging = paging;
    session.render.detail = 0.0;
    renderer.load(source_of(volume), {.minimum = volume.minimum, .maximum = volume.maximum}, session.render, true);
    const Camera camera = perspective({150, -60, 90}, {38, 22, 35}, 40.0);
    const auto draw = [&](const Session& look) {
        Picture picture = renderer.render(look, camera, {.count_work = true});
        CHECK(picture.complete);
        CHECK(is_in_buffer(picture.graph) == (std::string(home) == "buffer"));
        return picture;
    };
    PicturesAtHome all;
    all.pictures.push_back(draw(session));
    Annotator annotator(renderer);
    CHECK(annotator.paint({.brush = Brush::flood,
                           .group = 3,
                           .threshold = 0.4 * volume.maximum,
                           .radius_voxels = 14.0,
                           .path = {{30.5, 20.5, 31.5}, {44.5, 24.5, 38.5}}}) > 100);
    all.pictures.push_back(draw(session));
    Session exact = session;
    exact.render.exact_integral = true;
    all.pictures.push_back(draw(exact));
    Session lit = session;
    lit.light.occlusion = {.strength = 0.9, .radius = 4.0, .rays = 2};
    all.pictures.push_back(draw(lit));
    all.seen = renderer.pick(session.look(), camera, {40, 30}, {20, 15});
    for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    return all;
}

}  // namespace

TEST_CASE("densities in a buffer give the bits, the picks and the work of those in images")
{
    for (const VoxelType type : {VoxelType::uint8, VoxelType::uint16})
        for (const Paging paging : {Paging::never, Paging::always}) {
            CAPTURE(int(type));
            CAPTURE(int(paging));
            const PicturesAtHome image = pictures_at("image", type, paging),
                                 buffer = pictures_at("buffer", type, paging);
            for (size_t i = 0; i < image.pictures.size(); ++i) {
                CAPTURE(i);
                CHECK(different_bits(image.pictures[i].image, buffer.pictures[i].image) == 0);
                CHECK(work_of(image.pictures[i]) == work_of(buffer.pictures[i]));
                if (i > 0) CHECK(different_bits(image.pictures[i].image, image.pictures[i - 1].image) > 100);
            }
            REQUIRE(image.seen.has_value());
            REQUIRE(buffer.seen.has_value());
            CHECK(image.seen->point == buffer.seen->point);
            CHECK(image.seen->opacity == buffer.seen->opacity);
        }
}

TEST_CASE("every feature of a picture has the same bits with densities in a buffer")
{
    const auto pictures = [](const char* home) {
        const Home there(home);
        Everything everything;
        std::vector<ImageF> images;
        for (const Paging paging : {Paging::never, Paging::always})
            for (const Feature& feature : FEATURES) {
                Scenery scenery = everything.plain();
                scenery.is_painted = true;
                feature.add(scenery);
                scenery.paging = paging;
                const Picture picture = everything.draw(scenery);
                const bool is_filtered = scenery.sampling != Sampling::exact;
                CHECK(is_in_buffer(picture.graph) == (std::string(home) == "buffer" && !is_filtered));
                images.push_back(picture.image);
            }
        return images;
    };
    const std::vector<ImageF> image = pictures("image"), buffer = pictures("buffer");
    for (size_t i = 0; i < image.size(); ++i) {
        CAPTURE(std::string(FEATURES[i % FEATURES.size()].name));
        CHECK(different_bits(image[i], buffer[i]) == 0);
    }
}

TEST_CASE("a home of densities that does not exist is refused")
{
    const Home there("texture");
    CHECK_THROWS_WITH(gpu::Device(), "SHVR_ATLAS is 'texture'; expected image or buffer");
}
