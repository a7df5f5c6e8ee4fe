// Bricks that come and go: pictures equal those of volumes that are wholly on the device, bit for bit, whatever the budget.

#include <doctest/doctest.h>

#include "engine/volume/pyramid_source.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

std::shared_ptr<const VolumeSource> tubes(const Size3& size, VoxelType type = VoxelType::uint8)
{
    return open_procedural({.kind = "tubes", .size = size, .seed = 3, .type = type});
}

Session session_of(double opacity, bool shaded)
{
    Session session;
    session.transfer_function = TransferFunction({{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0},
                                                  {140.0, glm::dvec3(0.9, 0.7, 0.3), opacity},
                                                  {255.0, glm::dvec3(1.0), opacity}});
    session.light.shaded = shaded;
    session.render.size = {160, 120};
    session.render.sampling = Sampling::exact;
    session.render.detail = 0.0;
    return session;
}

/// A renderer of its own, with a budget; it outlives no test case.
struct Paged {
    Renderer renderer;
    explicit Paged(uint64_t device_mib, uint64_t host_mib = 0)
        : renderer({.device = {"", true}, .budget = {device_mib << 20, host_mib << 20}, .threads = 2})
    {}
    ~Paged()
    {
        for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    }
    Picture picture(std::shared_ptr<const VolumeSource> source, Session session, Paging paging, const Camera& camera)
    {
        session.render.paging = paging;
        const VolumeStatistics statistics{.minimum = 0.0, .maximum = 255.0};
        renderer.load(std::move(source), statistics, session.render);
        return renderer.render(session, camera);
    }
};

}  // namespace

TEST_CASE("paged pictures of the finest level equal resident ones bit for bit")
{
    const std::shared_ptr<const VolumeSource> source = tubes({150, 131, 170});
    const VolumeInfo& info = source->info();
    Camera inside = camera_looking("front", info);
    inside.eye = glm::dvec3(70.0, 20.0, 80.0);
    Camera parallel = camera_looking("left", info);
    parallel.projection = Camera::Projection::orthographic;
    for (const double opacity : {0.02, 1.0})
        for (const bool shaded : {false, true})
            for (const Camera& camera : {camera_looking("front", info), inside, parallel}) {
                Paged all(0);
                const Session session = session_of(opacity, shaded);
                const Picture expected = all.picture(source, session, Paging::never, camera);
                const Picture seen = all.picture(source, session, Paging::always, camera);
                CHECK(seen.complete);
                CHECK(different_bits(seen.image, expected.image) == 0);
            }
}
