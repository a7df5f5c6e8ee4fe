#pragma once
// Sources, budgets and sessions for tests of paged bricks.

#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <doctest/doctest.h>
#include <glm/gtc/matrix_transform.hpp>

#include "engine/live/view.h"
#include "tests/support/gpu.h"
#include "tests/support/nap.h"
#include "tests/support/stored_volume.h"

namespace shvr::test {

using Source = std::shared_ptr<const VolumeSource>;
constexpr VolumeStatistics BYTES{.minimum = 0.0, .maximum = 255.0};

inline Source tubes(const Size3& size)
{
    return stored_volume("tubes", size, 3);
}

/// Finest bricks everywhere, exact samples.
inline Session session_of(double opacity, bool shaded)
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

/// A renderer with its own budget.
struct Budgeted {
    Renderer renderer;
    explicit Budgeted(uint64_t device_mib = 0, uint64_t host_mib = 0)
        : renderer({.device = {.validation = true}, .budget = {device_mib << 20, host_mib << 20}, .threads = 2})
    {}
    ~Budgeted()
    {
        for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    }
    void load(const Source& source, Session session, Paging paging)
    {
        session.render.paging = paging;
        renderer.load(source, BYTES, session.render);
    }
    Picture picture(const Source& source, const Session& session, Paging paging, const Camera& camera)
    {
        load(source, session, paging);
        return renderer.render(session, camera);
    }
    DeviceVolume::Counts counts() { return renderer.volume().counts().value(); }
};

/// A source with some unreadable bricks.
class Broken final : public VolumeSource {
public:
    explicit Broken(Source source) : VolumeSource(source->info()), source_(std::move(source)) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    int levels() const override { return source_->levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        if (level == 0 && box.lower.x < 32) fail("chunk 0.0.0: is torn");
        source_->read_level(level, box, voxels);
    }

private:
    Source source_;
};

/// One value everywhere, with all its levels: of any size.
class Plain final : public VolumeSource {
public:
    Plain(const Size3& size, int levels) : VolumeSource({.name = "plain", .size = size}), levels_(levels) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    int levels() const override { return levels_; }
    void read_level(int, const VoxelBox&, std::span<std::byte> voxels) const override
    {
        std::ranges::fill(voxels, std::byte{200});
    }

private:
    int levels_;
};

/// A source whose brick ranges show that only bricks with x below 64 hold visible values.
class Sparse final : public VolumeSource {
public:
    Sparse(const Size3& size, int levels) : VolumeSource({.name = "sparse", .size = size}), levels_(levels) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    int levels() const override { return levels_; }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        size_t i = 0;
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x) voxels[i++] = std::byte(x << level < 64 ? 200 : 10);
    }
    std::optional<ValueRange> brick_range(int level, const Size3& brick) const override
    {
        return brick.x * 32 << level < 64 ? ValueRange{10.0, 200.0} : ValueRange{10.0, 10.0};
    }

private:
    int levels_;
};

inline Camera turned(const VolumeInfo& info, double degrees)
{
    Camera camera = camera_looking("front", info);
    const glm::dmat4 turn = glm::rotate(glm::dmat4(1.0), glm::radians(degrees), camera.up);
    camera.eye = camera.target + glm::dvec3(turn * glm::dvec4(camera.eye - camera.target, 0.0));
    return camera;
}

inline void settle(View& view)
{
    for (int i = 0; !view.complete(); ++i) {
        nap(i);
        REQUIRE(i < 10'000'000);
        view.advance();
    }
}

}  // namespace shvr::test
