// Costs of annotation: a stroke on a device, the picture after it, undoing it, its journal, one more node in a long
// trace, and ten thousand strokes on a volume of 1024^3 voxels. Times are of this machine, and of this run; bytes and
// voxels are always the same.

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <random>

#include "engine/annotation/trace/trace_command.h"
#include "engine/base/error.h"
#include "engine/device/trace_surfaces.h"
#include "engine/live/annotator.h"
#include "engine/volume/procedural/source_procedural.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

template <class Do>
double milliseconds_of(const Do& what)
{
    const auto begin = std::chrono::steady_clock::now();
    what();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

double median(std::vector<double> values)
{
    std::ranges::sort(values);
    return values[values.size() / 2];
}

double resident_mib()
{
    std::FILE* const file = std::fopen("/proc/self/statm", "r");
    long all = 0, resident = 0;
    if (!file || std::fscanf(file, "%ld %ld", &all, &resident) != 2) resident = 0;
    if (file) std::fclose(file);
    return double(resident) * double(::sysconf(_SC_PAGESIZE)) / (1 << 20);
}

class Folder {
public:
    Folder() : path(fs::temp_directory_path() / sentence("shvr-annotation-", ::getpid()))
    {
        fs::create_directory(path);
    }
    ~Folder() { fs::remove_all(path); }
    const fs::path path;
};

Session session_of(const VolumeInfo& volume)
{
    return parse_session(sentence(R"({"shvr_session": 1, "volume": {"procedural": "tubes", "size": [)", volume.size.x,
                                  ",", volume.size.y, ",", volume.size.z,
                                  R"(]}, "transfer_function": {"points": [
                                     {"intensity": 90, "color": "#806040", "opacity": 0.0},
                                     {"intensity": 255, "color": "#ffe0c0", "opacity": 0.4}]},
                                     "groups": {"3": {"name": "painted", "color": "#ff2020", "opacity": 0.5}},
                                     "render": {"size": [512, 512]}})"),
                         ".", "bench");
}

/// One hundred positions at radius 16, on 512^3.
void one_stroke(const Folder& folder)
{
    constexpr int POSITIONS = 100, ROUNDS = 15;
    std::shared_ptr<const VolumeSource> source = open_procedural({.kind = "tubes", .size = Size3(512)});
    const VolumeInfo& volume = source->info();
    Renderer renderer({});
    const Session session = session_of(volume);
    renderer.load(source, {.minimum = 0.0, .maximum = 255.0}, session.render);
    Annotator annotator(renderer);
    annotator.open({.journal = folder.path / "stroke.journal", .volume = volume});
    PaintOp op{.brush = Brush::fill, .group = 3, .threshold = 90.0, .radius_voxels = 16.0};
    // Where there is most to paint, of a few places.
    std::mt19937 random(1);
    int64_t most = -1;
    std::vector<glm::dvec3> path;
    for (int tries = 0; tries < 20; ++tries) {
        const glm::dvec3 at(double(20 + random() % 370) + 0.5, double(20 + random() % 470),
                            double(20 + random() % 470));
        op.path = {at, at + glm::dvec3(POSITIONS - 1, 0.0, 0.0)};
        const int64_t count = annotator.select(op).count();
        if (count > most) path = op.path;
        most = std::max(most, count);
    }
    op.path = path;

    const Camera camera = camera_named(session, "front", volume);
    const auto draw = [&] { return renderer.render(session, camera); };
    draw();
    std::vector<double> selecting, painting, undoing, redoing, before, after, journaling;
    int64_t voxels = 0, bytes = 0;
    for (int round = 0; round < ROUNDS; ++round) {
        draw();  // the work that the last undo left
        before.push_back(milliseconds_of(draw));
        selecting.push_back(milliseconds_of([&] { annotator.select(op); }));
        annotator.work().flush();
        const uint64_t begun = annotator.work().journal().bytes;
        painting.push_back(milliseconds_of([&] { voxels = annotator.paint(op); }));
        journaling.push_back(milliseconds_of([&] { annotator.work().flush(); }));
        bytes = int64_t(annotator.work().journal().bytes - begun);
        after.push_back(milliseconds_of(draw));
        undoing.push_back(milliseconds_of([&] { annotator.undo(); }));
        redoing.push_back(milliseconds_of([&] { annotator.redo(); }));
        annotator.undo();
    }
    std::printf("stroke of %d positions, radius 16, on 512^3 (%s): %lld voxels\n", POSITIONS,
                renderer.device().traits().name.c_str(), static_cast<long long>(voxels));
    std::printf("  a position: device and read-back %.2f ms, records, journal and bricks back %.2f ms\n",
                median(selecting) / POSITIONS, (median(painting) - median(selecting)) / POSITIONS);
    std::printf("  undo %.1f ms, redo %.1f ms; until it is on the disk %.1f ms\n", median(undoing), median(redoing),
                median(journaling));
    std::printf("  picture of 512x512 before %.1f ms, after %.1f ms: %.2f\n", median(before), median(after),
                median(after) / median(before));
    if (voxels > 0)
        std::printf("  journal: %lld bytes, %.3f a voxel\n", static_cast<long long>(bytes),
                    double(bytes) / double(voxels));
}

/// A hundred thousand nodes in branches of a hundred, to which one is added at a time.
void long_trace()
{
    constexpr uint32_t NODES = 100'000, BRANCH = 100, ADDED = 200;
    Renderer renderer({});
    const std::shared_ptr<const VolumeSource> source = open_procedural({.kind = "tubes", .size = Size3(64)});
    renderer.load(source, {.minimum = 0.0, .maximum = 255.0}, session_of(source->info()).render);
    std::mt19937 random(1);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    TraceGraph trace;
    glm::dvec3 at(0.0);
    const auto add = [&](uint32_t number) {
        std::vector<Change> changes{TraceNodeChange{number, {}, TraceNode{.position = at}}};
        if (number % BRANCH > 0) changes.push_back(TraceInternodeChange{number, {}, {{number - 1, number, 1}}});
        for (const Change& change : changes) trace.apply(std::get<TraceChange>(change), Direction::forwards);
        return changes;
    };
    for (uint32_t number = 0; number < NODES; ++number) {
        if (number % BRANCH == 0) at = {uniform(0, 1000), uniform(0, 1000), uniform(0, 1000)};
        at += glm::dvec3(uniform(-3, 3), uniform(-3, 3), uniform(-3, 3));
        add(number);
    }
    const double all = milliseconds_of([&] { renderer.scene().show_surfaces({}, trace, {}); });
    std::vector<double> finding, showing, counting;
    for (uint32_t i = 0; i < ADDED; ++i) {
        at = {uniform(0, 1000), uniform(0, 1000), uniform(0, 1000)};
        finding.push_back(milliseconds_of([&] { trace.nearest_node(at); }));
        const std::vector<Change> changes = add(NODES + i);
        showing.push_back(milliseconds_of([&] { renderer.scene().show_trace(trace, changes); }));
        counting.push_back(milliseconds_of([&] { trace.summary(); }));
    }
    std::printf(
        "a node more in a trace of %u: nearest node %.3f ms, its surfaces %.2f ms (all of them %.0f ms), "
        "lengths and segments %.4f ms\n",
        NODES, median(finding), median(showing), all, median(counting));
}

/// Without a device, which does not take part in it: every voxel of the brush is selected.
void many_strokes(const Folder& folder)
{
    constexpr int STROKES = 10000;
    const Size3 size(1024);
    WorkFiles files{.journal = folder.path / "many.journal", .volume = {}};
    files.volume.size = size;
    std::mt19937 random(1);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    int64_t voxels = 0;
    const double resident_before = resident_mib();
    auto work = std::make_unique<Work>(size, VoxelType::uint8);
    work->open(files);
    const double painting = milliseconds_of([&] {
        for (int stroke = 0; stroke < STROKES; ++stroke) {
            VoxelSelection selection(size);
            glm::dvec3 at(uniform(20, 1004), uniform(20, 1004), uniform(20, 1004));
            for (int position = 0; position < 8; ++position, at.x += 1.0) {
                const BrushRegion region = make_region(RegionShape::ball, at, 6.0, glm::dvec3(1.0), size);
                selection.add(region, std::vector<uint32_t>(size_t(region.words_per_row()) * region.rows.size(), ~0u));
            }
            Command command{"fill, group 3",
                            as_changes(paint_changes(work->document().mask, selection, {uint8_t(1 + stroke % 7)}))};
            for (const Change& change : command.changes) voxels += std::get<MaskBrickChange>(change).voxels();
            work->perform(std::move(command));
        }
        work->flush();
    });
    const double resident_after = resident_mib();
    const auto painted = int64_t(work->document().mask.painted_bricks().size());
    const double undoing = milliseconds_of([&] {
        for (int i = 0; i < 100; ++i) work->undo();
    });
    for (int i = 0; i < 100; ++i) work->redo();
    work.reset();
    std::printf("%d strokes of 8 positions, radius 6, on 1024^3: %lld voxels in %lld bricks\n", STROKES,
                static_cast<long long>(voxels), static_cast<long long>(painted));
    std::printf("  a stroke %.2f ms with its journal, undo %.2f ms\n", painting / STROKES, undoing / 100);
    std::printf("  memory %.0f MiB, of which bricks %.0f MiB\n", resident_after - resident_before,
                double(painted) * double(sizeof(MaskBrick)) / (1 << 20));
    std::printf("  journal %.1f MiB, %.3f bytes a voxel\n", double(fs::file_size(files.journal)) / (1 << 20),
                double(fs::file_size(files.journal)) / double(voxels));
    std::unique_ptr<Work> again;
    std::printf("  opened again in %.0f ms\n", milliseconds_of([&] {
                    again = std::make_unique<Work>(size, VoxelType::uint8);
                    again->open(files);
                }));
}

}  // namespace

}  // namespace shvr

int main()
{
    try {
        const shvr::Folder folder;
        shvr::one_stroke(folder);
        shvr::long_trace();
        shvr::many_strokes(folder);
        return 0;
    } catch (const shvr::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
