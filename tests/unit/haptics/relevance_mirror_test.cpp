// The mirror of relevance with a servo at its end. Both have their own threads, in step on a virtual clock, so that
// nothing depends on the machine; the main thread is held for as long as they run.

#include "engine/live/relevance_mirror.h"

#include <atomic>
#include <cmath>
#include <condition_variable>

#include <doctest/doctest.h>

#include "engine/workbench/touch/felt_relevance.h"
#include "haptics/servo.h"
#include "tests/support/haptic_scenes.h"

using namespace shvr;

namespace {

constexpr uint64_t MILLISECOND = 1'000'000;
constexpr double VOXEL_MM = 0.25;
constexpr int64_t LENGTH = 400;

/// A rod along x of 1 mm in a box of 100 x 16 x 16 mm; unreadable while `is_torn`.
class RodSource final : public VolumeSource {
public:
    RodSource() : VolumeSource(info()) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        if (is_torn) fail("rod: is torn");
        const Rod rod{.point = {0.0, 8.0, 8.0}, .radius = 1.0};
        size_t i = 0;
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y)
                for (int64_t x = box.lower.x; x < box.upper.x; ++x, ++i)
                    voxels[i] = std::byte(rod.holds((glm::dvec3(x, y, z) + 0.5) * VOXEL_MM) ? 200 : 20);
    }
    mutable std::atomic<bool> is_torn{false};

private:
    static VolumeInfo info()
    {
        VolumeInfo volume;
        volume.name = "rod";
        volume.size = {LENGTH, 64, 64};
        volume.type = VoxelType::uint8;
        volume.spacing = glm::dvec3(VOXEL_MM);
        return volume;
    }
};

/// The clock of servo and mirror. A tick of the servo begins once the mirror has done the work due before.
struct Turns {
    std::mutex mutex;
    std::condition_variable changed;
    uint64_t now_ns = 1'000'000'000, mirror_due_ns = 0;
    bool mirror_waits = false, has_ended = false, may_begin = false;
    int ticks = 0, to_run = 0;
    bool is_held = false;                 ///< the mirror is not served any more, as by a blocked main thread
    std::function<void(int)> every_tick;  ///< in the servo's thread

    void mirror_waits_until(uint64_t until_ns)
    {
        std::unique_lock lock(mutex);
        mirror_due_ns = until_ns;
        mirror_waits = true;
        changed.notify_all();
        changed.wait(lock, [&] { return has_ended || (!is_held && now_ns >= mirror_due_ns); });
        mirror_waits = false;
    }
    void servo_waits_until(uint64_t deadline_ns)
    {
        std::unique_lock lock(mutex);
        changed.wait(lock, [&] { return may_begin && (has_ended || ticks < to_run); });
        if (has_ended) return;
        now_ns = deadline_ns;
        changed.notify_all();
        changed.wait(lock, [&] { return has_ended || (mirror_waits && (is_held || mirror_due_ns > now_ns)); });
        lock.unlock();
        if (every_tick) every_tick(ticks);
        lock.lock();
        ++ticks;
        changed.notify_all();
    }
    /// Blocks the calling thread until `count` more ticks have run.
    void run(int count)
    {
        std::unique_lock lock(mutex);
        to_run += count;
        may_begin = true;
        changed.notify_all();
        changed.wait(lock, [&] { return ticks == to_run; });
    }
    void end()
    {
        const std::scoped_lock lock(mutex);
        has_ended = true;
        changed.notify_all();
    }
};

class TurnPacing : public Pacing {
public:
    explicit TurnPacing(Turns& turns) : turns_(turns) {}
    uint64_t now_ns() noexcept override
    {
        const std::scoped_lock lock(turns_.mutex);
        return turns_.now_ns;
    }
    void wait_until(uint64_t deadline_ns) noexcept override { turns_.servo_waits_until(deadline_ns); }

private:
    Turns& turns_;
};

/// A hand that moves along x at `speed`, m/s, 0.4 mm from the rod's middle.
class MovingHand : public HapticDevice {
public:
    explicit MovingHand(double speed) : speed_(speed) {}
    DeviceCaps caps() const noexcept override { return {.outputs_force = false}; }
    ReadResult read(DeviceState& state) noexcept override
    {
        ++reads_;
        state = {};
        state.time_ns = reads_ * MILLISECOND;
        state.sequence = uint32_t(reads_);
        state.position_m = {0.010 + speed_ * double(reads_) * 1e-3, 0.0084, 0.008};
        return ReadResult::fresh;
    }
    bool write(const glm::dvec3&, uint32_t) noexcept override { return true; }

private:
    double speed_;
    uint64_t reads_ = 0;
};

/// Servo and mirror, and how the servo fared.
struct World {
    std::shared_ptr<RodSource> source = std::make_shared<RodSource>();
    Turns turns;
    RelevanceChoice choice;
    int blind = 0;                              ///< ticks whose relevance was missing, too old or of other settings
    double least_n = 1e9;                       ///< force
    double last_n = 0.0, largest_step_n = 0.0;  ///< force in the last tick, and its largest change between two
    int device_answers = 0;
    std::unique_ptr<Servo> servo;
    std::unique_ptr<RelevanceMirror> mirror;

    World(double speed, TouchMode mode)
    {
        servo = std::make_unique<Servo>(std::make_unique<MovingHand>(speed), std::make_unique<TurnPacing>(turns),
                                        Servo::Options{.rate_hz = 1000, .realtime = false});
        ForceSettings settings{.assistance = true, .probe_radius = 2.5};
        settings.workspace = {glm::dmat3(1000.0), glm::dvec3(0.0)};
        settings.mode = mode;
        settings.relevance_settings = 7;
        servo->settings().publish(settings);
        mirror = std::make_unique<RelevanceMirror>(
            RelevanceMirror::Ends{.probe = [this]() -> std::optional<ProbeMotion> {
                                      servo->place().take();
                                      const ProbePlace& place = servo->place().value();
                                      if (!place.is_known) return std::nullopt;
                                      return ProbeMotion{place.point, place.velocity};
                                  },
                                  .publish = [this](const MirroredRelevance& mirrored) { publish(mirrored); },
                                  .now_ns =
                                      [this] {
                                          const std::scoped_lock lock(turns.mutex);
                                          return turns.now_ns;
                                      },
                                  .wait = [this](uint64_t until_ns) { turns.mirror_waits_until(until_ns); }});
        choice = {.source = source, .threshold = 100.0, .radius = 2.5, .settings = 7};
        mirror->choose(choice);
        turns.every_tick = [this](int) { watch(); };
    }
    ~World()
    {
        turns.end();
        mirror.reset();
        servo.reset();
    }
    void publish(const MirroredRelevance& mirrored)
    {
        ui::put_mirrored(mirrored, servo->relevance().writing());
        servo->relevance().publish();
    }
    void watch()
    {
        if (!servo->state().take()) return;
        const ServoState& state = servo->state().value();
        blind += (state.step.flags & FORCE_NO_REGION) != 0;
        const double now_n = glm::length(state.step.force_n);
        least_n = std::min(least_n, now_n);
        largest_step_n = std::max(largest_step_n, std::abs(now_n - last_n));
        last_n = now_n;
    }
    /// Answers like a device, sixty times a second, `late_ticks` after each request.
    void answer(int late_ticks)
    {
        turns.every_tick = [this, late_ticks, asked = std::optional<RelevanceMirror::Wanted>{},
                            due = 0](int tick) mutable {
            watch();
            if (asked && tick >= due) {
                mirror->offer(*asked, relevance_on_host(*source, 0, asked->place.box, asked->threshold));
                asked.reset();
                ++device_answers;
            }
            if (asked || tick % 16 != 0) return;
            asked = mirror->wanted();
            due = tick + late_ticks;
        };
    }
    /// Until the force is there, and then watched.
    void begin()
    {
        turns.run(400);
        blind = 0;
        least_n = 1e9;
    }
};

}  // namespace

TEST_CASE("while the main thread is held nothing fades, whether the hand rests in the cube or leaves it")
{
    for (const TouchMode mode : {TouchMode::proximity, TouchMode::object, TouchMode::surface}) {
        for (const double speed : {0.0, 0.02, 0.04}) {
            CAPTURE(int(mode));
            CAPTURE(speed);
            World world(speed, mode);
            world.begin();
            world.turns.run(1500);
            CHECK(world.blind == 0);
            if (mode != TouchMode::surface) CHECK(world.least_n > 0.05);
            CHECK(world.mirror->made_on_host() >= (speed > 0.0 ? 3 : 1));
            CHECK(world.mirror->made_on_host() <= 30);
        }
    }
}

TEST_CASE("a mirror that stands still does fade: the check above can fail")
{
    World world(0.0, TouchMode::object);
    world.begin();
    {
        const std::scoped_lock lock(world.turns.mutex);
        world.turns.is_held = true;
    }
    world.turns.run(1000);
    CHECK(world.blind > 900);
    CHECK(world.least_n == 0.0);
}

TEST_CASE("a device that answers in time is enough; the host steps in for one that is late, declines or says nothing")
{
    for (const int late_ticks : {2, 10, 200}) {
        CAPTURE(late_ticks);
        World world(0.02, TouchMode::proximity);
        world.answer(late_ticks);
        world.begin();
        const uint64_t before = world.mirror->made_on_host();
        world.turns.run(1500);
        CHECK(world.blind == 0);
        CHECK(world.least_n > 0.05);
        if (late_ticks <= 10) {
            CHECK(world.device_answers >= 3);
            CHECK(world.mirror->made_on_host() == before);
        } else {
            CHECK(world.mirror->made_on_host() > before);
        }
    }
}

TEST_CASE("another threshold takes effect within the time that a force needs to fade, and is not mixed with the last")
{
    World world(0.0, TouchMode::proximity);
    world.begin();
    world.turns.run(100);
    world.choice.threshold = 250.0;  // nothing is left
    world.choice.settings = 8;
    world.mirror->choose(world.choice);
    ForceSettings settings{.assistance = true, .probe_radius = 2.5};
    settings.workspace = {glm::dmat3(1000.0), glm::dvec3(0.0)};
    settings.relevance_settings = 8;
    world.servo->settings().publish(settings);
    world.turns.run(60);
    CHECK(world.blind > 0);
    world.blind = 0;
    world.turns.run(100);
    CHECK(world.blind == 0);
    CHECK(world.least_n < 1e-6);
}

TEST_CASE("voxels that cannot be read fade out with a sentence, and are read again a second later")
{
    World world(0.02, TouchMode::proximity);
    world.begin();
    world.source->is_torn = true;
    world.turns.run(800);
    CHECK(world.blind > 0);
    CHECK(world.mirror->trouble().find("torn") != std::string::npos);
    world.source->is_torn = false;
    world.turns.run(1000);
    world.blind = 0;
    world.turns.run(300);
    CHECK(world.blind == 0);
    CHECK(world.mirror->trouble().empty());
}

// Kind (Touch): a cutting plane that moves through what is touched
TEST_CASE("a cut through what is touched is felt at once, without another answer, a blind tick or a jolt")
{
    World world(0.0, TouchMode::proximity);
    world.begin();
    world.turns.run(200);
    const double whole_n = world.last_n;
    CHECK(whole_n > 0.05);
    const uint64_t made = world.mirror->made_on_host();
    const auto cut_at = [&](double x) {
        world.choice.limits.cut = {{x, 0.0, 0.0}, {double(LENGTH), 64.0, 64.0}};
        world.mirror->choose(world.choice);
    };
    // All that is touched goes at once, and comes back.
    for (const bool is_cut : {true, false}) {
        CAPTURE(is_cut);
        world.largest_step_n = 0.0;
        cut_at(is_cut ? double(LENGTH) : 0.0);
        world.turns.run(20);
        CHECK(world.last_n > 0.1 * whole_n);
        CHECK(world.last_n < 0.9 * whole_n);
        world.turns.run(180);
        if (is_cut) CHECK(world.last_n < 1e-6);
        if (!is_cut) CHECK(world.last_n == doctest::Approx(whole_n));
        CHECK(world.largest_step_n < 0.02 * whole_n);
    }
    // A plane is dragged over the ball, a quarter of a voxel every 16 ms.
    world.largest_step_n = 0.0;
    for (double x = 24.0; x < 56.0; x += 0.25) {
        cut_at(x);
        world.turns.run(16);
    }
    world.turns.run(150);
    CHECK(world.last_n < 1e-6);
    CHECK(world.largest_step_n < 0.05);
    CHECK(world.blind == 0);
    CHECK(world.mirror->made_on_host() == made);
}

TEST_CASE("intensities that are not shown are not felt: the host reads them, whatever the device offers")
{
    World world(0.0, TouchMode::proximity);
    world.answer(2);
    world.begin();
    CHECK(world.last_n > 0.05);
    world.choice.limits.unpainted = IntensityIntervals{{220.0, 255.0}};  // the rod is 200
    ++world.choice.voxels;
    world.mirror->choose(world.choice);
    const uint64_t made = world.mirror->made_on_host();
    world.turns.run(300);
    CHECK(world.last_n < 1e-6);
    CHECK(world.mirror->made_on_host() == made + 1);
    CHECK(world.blind == 0);
    world.choice.limits.unpainted.reset();
    ++world.choice.voxels;
    world.mirror->choose(world.choice);
    world.turns.run(300);
    CHECK(world.last_n > 0.05);
    CHECK(world.mirror->made_on_host() == made + 1);
}

TEST_CASE("offsets that a person paints are felt once the choice tells of them")
{
    World world(0.0, TouchMode::proximity);
    world.begin();
    const uint64_t made = world.mirror->made_on_host();
    auto field = std::make_shared<DensityField>(Size3(LENGTH, 64, 64), VoxelType::uint8);
    OffsetBrick lowered{};
    lowered.fill(offset_bits(VoxelType::uint8, -200.0));
    const Size3 counts = field->brick_counts();
    for (int64_t brick = 0; brick < counts.x * counts.y * counts.z; ++brick) field->put(brick, lowered);
    world.choice.offsets = field;
    world.choice.voxels = 1;
    world.mirror->choose(world.choice);
    world.turns.run(300);
    CHECK(world.mirror->made_on_host() == made + 1);
    CHECK(world.blind == 0);  // the last bits were young enough meanwhile
    CHECK(world.least_n < 1e-6);
}
