// Threads that wait while the driver compiles: painting, clicking and moving the probe never do, even with an empty
// cache. A layer counts which thread compiles (tests/layers/cache.cpp); the device says that it is a GPU.

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <thread>

#include <unistd.h>

#include <doctest/doctest.h>

#include "engine/live/annotator.h"
#include "engine/live/view.h"
#include "tests/support/gpu.h"

using namespace shvr;
using namespace shvr::test;

namespace {

/// Folders and variables of the environment, for as long as it lives.
class FirstStart {
public:
    FirstStart() : folder_(std::filesystem::temp_directory_path() / sentence("shvr-first-start-", getpid()))
    {
        std::filesystem::create_directories(folder_);
        if (const char* const cache = std::getenv("XDG_CACHE_HOME")) cache_ = cache;
        setenv("XDG_CACHE_HOME", folder_.c_str(), 1);
        setenv("SHVR_CACHE_LOG", log().c_str(), 1);
        setenv("VK_INSTANCE_LAYERS", "VK_LAYER_SHVR_limits:VK_LAYER_SHVR_cache", 1);
        setenv("SHVR_LIMITS", "nvidia", 1);
    }
    FirstStart(const FirstStart&) = delete;
    ~FirstStart()
    {
        if (cache_)
            setenv("XDG_CACHE_HOME", cache_->c_str(), 1);
        else
            unsetenv("XDG_CACHE_HOME");
        for (const char* name : {"SHVR_CACHE_LOG", "VK_INSTANCE_LAYERS", "SHVR_LIMITS"}) unsetenv(name);
        std::filesystem::remove_all(folder_);
    }
    /// A number of the log, which counts on from device to device.
    int count(const std::string& what) const
    {
        std::ifstream lines(log());
        std::string word;
        for (int number = 0; lines >> word >> number;)
            if (word == what) return number;
        FAIL(what);
        return 0;
    }

private:
    std::filesystem::path log() const { return folder_ / "log"; }
    std::filesystem::path folder_;
    std::optional<std::string> cache_;
};

struct Worked {
    std::shared_ptr<const VolumeSource> source = open_procedural({.kind = "tubes", .size = {70, 66, 68}, .seed = 3});
    Session session;
    Renderer renderer{{.device = {.looks_ahead = true}, .threads = 1}};
    View view{renderer, {}};
    std::optional<Annotator> annotator;

    explicit Worked(Paging paging)
    {
        session = plain_session({{40.0, RED, 0.0}, {120.0, WHITE, 0.2}, {255.0, BLUE, 0.5}}, {96, 64});
        session.light.shaded = true;
        session.light.occlusion.strength = 0.0;
        session.render.paging = paging;
        renderer.load(source, {.minimum = 0.0, .maximum = 255.0}, session.render);
        annotator.emplace(renderer);
    }
    const ProbeLook ball{.center = {30, 32, 33}, .radius = 12.0};

    Camera camera() const { return camera_looking("front", source->info()); }
    void see(const std::optional<ProbeLook>& probe = std::nullopt)
    {
        view.look(session.look(), session.interaction, Shot(camera()), session.render.size);
        view.show_probe(probe);
        const auto begin = std::chrono::steady_clock::now();
        while (!view.complete()) {
            REQUIRE(std::chrono::steady_clock::now() - begin < std::chrono::minutes(2));
            view.advance();
            std::this_thread::yield();
        }
        while (renderer.executor().expected_kernels() > 0) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    /// The work of a user who paints, clicks and moves the probe, which the first picture shows.
    void work()
    {
        PaintOp op;
        op.path = {{30, 32, 33}, {34, 30, 33}};
        op.radius_voxels = 9.0;
        op.threshold = 60.0;
        op.group = 3;
        for (const Brush brush : {Brush::fill, Brush::flood, Brush::speckle}) {
            op.brush = brush;
            ProbeLook previewed = ball;
            previewed.preview = std::make_shared<PaintPreview>(annotator->preview(op));
            see(previewed);
            annotator->paint(op);
            see(ball);
        }
        for (const bool is_box : {false, true}) {
            ProbeLook shelled = ball;
            shelled.shell = ShellLook{.threshold = 30000.0, .opacity = 0.3, .is_box = is_box};
            see(shelled);
        }
        static_cast<void>(renderer.pick(session.look(), camera(), session.render.size, {40, 30}, ball));
    }
};

}  // namespace

TEST_CASE("who paints, clicks and moves the probe waits for no compiler, even at a first start")
{
    for (const Paging paging : {Paging::never, Paging::always}) {
        CAPTURE(int(paging));
        const FirstStart start;
        static int waited_before = 0, made_before = 0;  // the layer counts on
        {
            Worked worked(paging);
            worked.see(worked.ball);
            const int waited = start.count("waited"), made = start.count("compiled");
            CHECK(waited > waited_before);                       // the first picture
            CHECK(made - made_before > waited - waited_before);  // and what is likely to follow
            worked.work();
            CHECK(start.count("waited") == waited);
            CHECK(start.count("compiled") > made);  // ever one step ahead
        }
        waited_before = start.count("waited");
        made_before = start.count("compiled");
    }
}
