// Density offsets of a volume on another machine: they are painted without waiting for its voxels, and shown when these
// have arrived, as if the volume were here.

#include <atomic>
#include <functional>
#include <optional>
#include <thread>

#include <doctest/doctest.h>

#include "engine/base/waits/waits.h"
#include "engine/live/annotator.h"
#include "engine/volume/levels/pyramid_source.h"
#include "tests/support/gpu.h"
#include "tests/support/nap.h"

using namespace shvr;
using namespace shvr::test;

namespace {

constexpr VolumeStatistics BYTES{.minimum = 0.0, .maximum = 255.0};

/// A volume on a machine that may be silent. Counts the reads of the thread that made it.
class Far final : public VolumeSource {
public:
    explicit Far(const Size3& size)
        : VolumeSource({.name = "far", .size = size}),
          near_(with_levels(open_procedural({.kind = "tubes", .size = size, .seed = 3}), uint64_t{1} << 30))
    {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override { read_level(0, box, voxels); }
    int levels() const override { return near_->levels(); }
    void read_level(int level, const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        if (std::this_thread::get_id() == main_) ++reads_of_main;
        while (is_silent) {
            stop_if_wait_is_over();
            std::this_thread::yield();
        }
        near_->read_level(level, box, voxels);
    }
    mutable std::atomic<int> reads_of_main = 0;
    std::atomic<bool> is_silent = false;

private:
    std::shared_ptr<const VolumeSource> near_;
    std::thread::id main_ = std::this_thread::get_id();
};

struct Desk {
    explicit Desk(const std::shared_ptr<Far>& far, Paging paging) : source(far)
    {
        renderer.load(far, BYTES, {.sampling = Sampling::exact, .paging = paging});
        annotator.emplace(renderer);
        renderer.scene().read_in_background(true);
    }
    ~Desk()
    {
        for (const std::string& message : renderer.device().take_validation_messages()) FAIL_CHECK(message);
    }
    ImageF picture()
    {
        Session session;
        session.transfer_function =
            TransferFunction({{90.0, glm::dvec3(0.8, 0.3, 0.1), 0.0}, {255.0, glm::dvec3(1.0), 0.2}});
        session.render.size = {96, 72};
        session.render.sampling = Sampling::exact;
        session.render.detail = 0.0;
        return renderer.render(session, camera_looking("front", renderer.volume().info())).image;
    }
    /// Paints by hand, as a window does, until `is_done`.
    void paint(const PaintOp& op, const std::function<bool()>& is_done)
    {
        annotator->begin_stroke(op);
        for (const glm::dvec3& at : op.path) annotator->extend_stroke(at);
        annotator->end_stroke();
        advance_until(is_done);
    }
    void advance_until(const std::function<bool()>& is_done)
    {
        for (int turn = 0; !is_done(); ++turn) {
            annotator->advance();
            renderer.scene().advance();
            nap(turn);
        }
    }
    bool is_at_rest() const { return !annotator->stroke_is_running() && !annotator->is_behind(); }

    std::shared_ptr<Far> source;
    Renderer renderer{{.device = {.validation = true}, .budget = {}, .threads = 2}};
    std::optional<Annotator> annotator;
};

PaintOp raise(const glm::dvec3& at, double threshold, double offset)
{
    PaintOp op{.brush = Brush::fill, .group = 1, .threshold = threshold, .radius_voxels = 6.0, .path = {at}};
    op.density = DensityBrush{offset, Falloff::flat};
    op.paints_group = false;
    return op;
}

}  // namespace

TEST_CASE("offsets of a far volume are painted without a wait, and shown once its voxels have arrived")
{
    for (const Paging paging : {Paging::never, Paging::always}) {
        const Size3 size(70, 66, 40);
        const auto far = std::make_shared<Far>(size), near = std::make_shared<Far>(size);
        Desk desk(far, paging), expected(near, paging);
        const ImageF untouched = desk.picture();
        static_cast<void>(expected.picture());
        expected.renderer.scene().read_in_background(false);
        const PaintOp first = raise({34, 30, 20}, 30.0, 60.0), second = raise({37, 30, 20}, 80.0, 90.0);
        const int64_t reached = expected.annotator->select(second).count();
        REQUIRE(expected.annotator->paint(first) > 0);
        const ImageF after_first = expected.picture();
        REQUIRE(expected.annotator->select(second).count() > reached);
        REQUIRE(expected.annotator->paint(second) > 0);
        const ImageF after_both = expected.picture();
        REQUIRE(different_bits(after_first, untouched) > 0);
        REQUIRE(different_bits(after_both, after_first) > 0);

        far->is_silent = true;
        far->reads_of_main = 0;
        Annotator& annotator = *desk.annotator;
        desk.paint(first, [&] { return !annotator.stroke_is_running(); });
        CHECK(annotator.is_behind());
        CHECK(annotator.document().density.voxels() > 0);
        const uint64_t revision = annotator.revision();
        for (int turn = 0; turn < 2 * Annotator::MAX_TRIES; ++turn) CHECK_FALSE(annotator.advance());
        CHECK(annotator.is_behind());
        // Another stroke waits, since its brush would not see the offsets of the first.
        desk.paint(second, [turn = 0]() mutable { return ++turn > 100; });
        CHECK(annotator.stroke_is_running());
        far->is_silent = false;
        desk.advance_until([&] { return desk.is_at_rest(); });
        CHECK(annotator.revision() > revision);
        CHECK(far->reads_of_main == 0);
        CHECK(annotator.document().density.painted_bricks() == expected.annotator->document().density.painted_bricks());
        CHECK(different_bits(desk.picture(), after_both) == 0);

        far->is_silent = true;
        far->reads_of_main = 0;
        REQUIRE(annotator.undo());
        REQUIRE(annotator.undo());
        CHECK(annotator.is_behind());
        far->is_silent = false;
        desk.advance_until([&] { return desk.is_at_rest(); });
        CHECK(far->reads_of_main == 0);
        CHECK(different_bits(desk.picture(), untouched) == 0);
    }
}

TEST_CASE(
    "a whole stroke in a far volume paints, once its bricks have arrived, what it paints when they are waited for")
{
    const Size3 size(70, 66, 40);
    const auto far = std::make_shared<Far>(size), near = std::make_shared<Far>(size);
    Desk desk(far, Paging::always), expected(near, Paging::always);
    expected.renderer.scene().read_in_background(false);
    PaintOp op =
        raise({20, 30, 20}, 30.0, 60.0);  // within its own reach, so that later regions would see earlier offsets
    op.paints_group = true;
    op.radius_voxels = 9.0;
    for (int i = 1; i < 200; ++i) op.path.emplace_back(20 + i % 30, 30 + i % 3, 20);
    const int64_t voxels = expected.annotator->paint(op);
    REQUIRE(voxels > 0);
    far->is_silent = true;
    far->reads_of_main = 0;
    desk.annotator->begin_whole_stroke(op);
    desk.advance_until([turn = 0]() mutable { return ++turn > 100; });
    CHECK(desk.annotator->stroke_is_running());
    CHECK(desk.annotator->history().undoable() == 0);
    far->is_silent = false;
    desk.advance_until([&] { return desk.is_at_rest(); });
    CHECK(far->reads_of_main == 0);
    CHECK(desk.annotator->history().undoable() == 1);
    CHECK(desk.annotator->last_stroke().voxels() == voxels);
    const Document& seen = desk.annotator->document();
    const Document& wanted = expected.annotator->document();
    CHECK(seen.mask.voxels_by_group() == wanted.mask.voxels_by_group());
    REQUIRE(seen.density.painted_bricks() == wanted.density.painted_bricks());
    for (const int64_t brick : wanted.density.painted_bricks())
        CHECK((*seen.density.brick(brick) == *wanted.density.brick(brick)));
    CHECK(different_bits(desk.picture(), expected.picture()) == 0);
}

TEST_CASE("a scene with offsets of a far volume goes away while their voxels are being read")
{
    const auto far = std::make_shared<Far>(Size3(70, 66, 40));
    Desk desk(far, Paging::always);
    static_cast<void>(desk.picture());
    far->is_silent = true;
    desk.paint(raise({34, 30, 20}, 30.0, 60.0), [&] { return !desk.annotator->stroke_is_running(); });
    CHECK(desk.annotator->is_behind());
}
