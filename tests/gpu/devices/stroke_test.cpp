// A stroke by hand on a device whose calls run out of memory (tests/layers/faults.cpp): it paints all that it would
// have painted, or reports that it did not.

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <thread>

#include <unistd.h>

#include <doctest/doctest.h>

#include "engine/base/image_metrics.h"
#include "engine/live/annotator.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Lets calls fail from now on, on devices created during its lifetime.
class Faults {
public:
    Faults()
    {
        std::filesystem::create_directories(folder_);
        setenv("VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_faults", 1);
        setenv("SHVR_FAULTS_NOW", (folder_ / "now").c_str(), 1);
    }
    Faults(const Faults&) = delete;
    ~Faults()
    {
        for (const char* name : {"VK_INSTANCE_LAYERS", "SHVR_FAULTS_NOW"}) unsetenv(name);
        std::filesystem::remove_all(folder_);
    }
    void let_fail(const std::string& faults) const
    {
        std::ofstream(folder_ / "new") << faults;
        std::filesystem::rename(folder_ / "new", folder_ / "now");
    }

private:
    std::filesystem::path folder_ = std::filesystem::temp_directory_path() / sentence("shvr-faults-", getpid());
};

struct Desk {
    Renderer renderer{{.device = {.validation = false}, .threads = 1}};
    std::shared_ptr<const VolumeSource> source = open_procedural({.kind = "tubes", .size = {96, 96, 96}, .seed = 3});
    Session session;
    int times_lost = 0;

    Desk()
    {
        session.render.size = {64, 48};
        session.render.sampling = Sampling::exact;
        renderer.load(source, {.minimum = 0.0, .maximum = 255.0}, session.render);
    }
    /// With paint and an offset that later regions see.
    PaintOp brush() const
    {
        return {.brush = Brush::fill,
                .group = 3,
                .threshold = 100.0,
                .radius_voxels = 5.0,
                .density = DensityBrush{.offset = 20.0}};
    }
    /// Paints back and forth, for dozens of queries; calls `before_turn` before each iteration. Counts the failures.
    template <class BeforeTurn>
    int paint(Annotator& annotator, const BeforeTurn& before_turn)
    {
        constexpr int TURNS = 60;
        using Clock = std::chrono::steady_clock;
        const Clock::time_point deadline = Clock::now() + std::chrono::minutes(5);  // turns have no bound: they wait
        int failed = 0;
        annotator.begin_stroke(brush());
        for (int turn = 0; annotator.stroke_is_running() || annotator.is_behind(); ++turn) {
            std::this_thread::yield();  // a driver that draws on this processor gets on
            if (Clock::now() > deadline) FAIL("the stroke has not ended");
            if (turn <= TURNS) annotator.extend_stroke({15.0 + turn, 15.0 + 66.0 * (turn % 2), 40.0});
            if (turn == TURNS) annotator.end_stroke();
            before_turn();
            try {
                static_cast<void>(annotator.advance());
                renderer.scene().advance();
            } catch (const gpu::MemoryError&) {
                ++failed;
            } catch (const gpu::DeviceLost&) {
                ++times_lost;
                annotator.drop_queries();
                renderer.restart();
                renderer.load(source, {.minimum = 0.0, .maximum = 255.0}, session.render);
                renderer.scene().show(annotator.document());
            }
        }
        return failed;
    }
    /// Faults that have not fired yet may do so.
    template <class Action>
    auto patiently(const Action& action)
    {
        for (int tries = 0;; ++tries) try {
                return action();
            } catch (const gpu::MemoryError&) {
                REQUIRE(tries < 10);
            }
    }
    /// Draws the document: in the scene as it is, or (`drawn_anew`) in one that is loaded again.
    ImageF drawn()
    {
        return patiently([&] { return renderer.render(session, camera_looking("front", source->info())).image; });
    }
    ImageF drawn_anew(const Document& document)
    {
        patiently([&] {
            renderer.load(source, {.minimum = 0.0, .maximum = 255.0}, session.render);
            renderer.scene().show(document);
            return 0;
        });
        return drawn();
    }
};

}  // namespace

TEST_CASE("a stroke goes on where memory was short for a moment, and is painted and shown as ever")
{
    const Faults faults;
    Desk desk;
    Annotator whole(desk.renderer);
    CHECK(desk.paint(whole, [] {}) == 0);
    REQUIRE(whole.document().mask.voxels_by_group()[3] > 500);

    desk.renderer.load(desk.source, {.minimum = 0.0, .maximum = 255.0}, desk.session.render);
    Annotator annotator(desk.renderer);
    std::mt19937 random(5);
    constexpr std::array CALLS{"vkEndCommandBuffer", "vkQueueSubmit2", "vkBeginCommandBuffer",
                               "vkAllocateDescriptorSets", "vkResetFences"};
    const int failed = desk.paint(annotator, [&] {
        if (random() % 3 > 0) return;
        faults.let_fail(sentence(CALLS[random() % CALLS.size()], ":", 1 + random() % 3, ":out_of_device_memory"));
    });
    CHECK(failed > 5);
    CHECK(annotator.strokes_done() == 1);
    CHECK(annotator.history().undoable() == 1);
    CHECK(annotator.last_stroke().voxels() == whole.last_stroke().voxels());
    CHECK(annotator.document().mask.voxels_by_group() == whole.document().mask.voxels_by_group());
    CHECK(annotator.document().density.painted_bricks() == whole.document().density.painted_bricks());

    const ImageF seen = desk.drawn();
    CHECK(different_bits(seen, desk.drawn_anew(annotator.document())) == 0);
}

TEST_CASE("what could not be shown for want of memory is shown at the next turn")
{
    const Faults faults;
    Desk desk;
    Annotator annotator(desk.renderer);
    PaintOp op = desk.brush();
    op.threshold = 0.0;
    for (const glm::dvec3& place : {glm::dvec3(20.0), glm::dvec3(75.0)}) {
        op.path = {place};
        REQUIRE(annotator.paint(op) > 0);
    }
    faults.let_fail("vkEndCommandBuffer:1:out_of_device_memory");
    CHECK(annotator.undo() != nullptr);  // is done, though it cannot be shown
    CHECK(annotator.history().undoable() == 1);
    REQUIRE(annotator.is_behind());
    static_cast<void>(desk.renderer.scene().take_changed());
    const uint64_t revision = annotator.revision();
    static_cast<void>(annotator.advance());
    CHECK_FALSE(annotator.is_behind());
    CHECK(annotator.revision() > revision);
    bool sees_first = false;  // nothing of the mask was there any more
    for (const Scene::Changed& changed : desk.renderer.scene().take_changed())
        sees_first = sees_first || glm::all(glm::lessThan(changed.voxels.lower, Size3(20)));
    CHECK(sees_first);
    const ImageF seen = desk.drawn();
    CHECK(different_bits(seen, desk.drawn_anew(annotator.document())) == 0);
}

TEST_CASE("a stroke under way when the device is lost is painted to its end on the new one")
{
    const Faults faults;
    Desk desk;
    Annotator whole(desk.renderer);
    CHECK(desk.paint(whole, [] {}) == 0);
    for (const char* call : {"vkWaitForFences", "vkQueueSubmit2"}) {
        CAPTURE(std::string(call));
        desk.renderer.load(desk.source, {.minimum = 0.0, .maximum = 255.0}, desk.session.render);
        Annotator annotator(desk.renderer);
        int turn = 0;
        desk.paint(annotator, [&] {
            if (++turn % 20 == 0 && turn < 100) faults.let_fail(sentence(call, ":2:device_lost"));
        });
        CHECK(desk.times_lost > 0);
        CHECK(annotator.strokes_done() == 1);
        CHECK(annotator.document().mask.voxels_by_group() == whole.document().mask.voxels_by_group());
        desk.times_lost = 0;
    }
}

TEST_CASE("a stroke that memory stays too short for ends, and says that its rest is not painted")
{
    const Faults faults;
    Desk desk;
    Annotator annotator(desk.renderer);
    annotator.begin_stroke(desk.brush());
    annotator.extend_stroke(glm::dvec3(40.0));
    annotator.end_stroke();
    faults.let_fail("vkEndCommandBuffer:1+:out_of_device_memory");
    std::vector<std::string> said;
    while (annotator.stroke_is_running()) try {
            static_cast<void>(annotator.advance());
        } catch (const gpu::MemoryError& error) {
            said.push_back(error.what());
            CHECK(annotator.stroke_is_running());
        } catch (const Error& error) {  // no more tries
            said.push_back(error.what());
            CHECK_FALSE(annotator.stroke_is_running());
        }
    REQUIRE(said.size() == size_t(Annotator::MAX_TRIES));
    CHECK(said.front().find("the stroke") == std::string::npos);
    CHECK(said.back() == said.front() + "; the rest of the stroke is not painted");
    CHECK(annotator.strokes_done() == 0);
}
