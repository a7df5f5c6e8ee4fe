// Times one operation on groups, or the surfaces of all groups, once: for tools/bench/editor.py, which runs it in turns
// with the same operation of another program. Prints one line of JSON. Reading, and copying the mask into bricks, is
// not timed; changing the mask is.

#include <chrono>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <iterator>

#include "engine/annotation/measures/measures.h"
#include "engine/annotation/meshes/group_surfaces.h"
#include "engine/annotation/operations/run_operation.h"
#include "engine/annotation/script/script.h"
#include "engine/base/file.h"
#include "engine/base/text.h"

namespace shvr {

namespace {

/// Bytes, x fastest, as a volume in memory that knows nothing of its voxels.
class BytesSource final : public VolumeSource {
public:
    static VolumeInfo info_of(const Size3& size)
    {
        VolumeInfo info;
        info.name = "bytes";
        info.size = size;
        info.unit = "mm";
        return info;
    }
    BytesSource(std::string bytes, const Size3& size) : VolumeSource(info_of(size)), bytes_(std::move(bytes)) {}
    void read(const VoxelBox& box, std::span<std::byte> voxels) const override
    {
        const Size3 size = box.size();
        for (int64_t row = 0; row < size.y * size.z; ++row) {
            const Size3 first = box.lower + Size3(0, row % size.y, row / size.y);
            const char* const from = bytes_.data() + index_of(first, info().size);
            std::copy_n(reinterpret_cast<const std::byte*>(from), size.x, voxels.begin() + row * size.x);
        }
    }

private:
    std::string bytes_;
};

Mask mask_of(const std::string& bytes, const Size3& size)
{
    Mask mask(size);
    const Size3 counts = mask.brick_counts();
    for (int64_t brick = 0; brick < counts.x * counts.y * counts.z; ++brick) {
        const VoxelBox box = mask.box_of(brick);
        MaskBrickChange change{.brick = brick, .runs = {}};
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y) {
                const Size3 first(box.lower.x, y, z);
                const auto* const row = reinterpret_cast<const uint8_t*>(bytes.data()) + index_of(first, size);
                append_painted_runs(change.runs, std::span(row, size_t(box.size().x)), index_in_brick(first));
            }
        if (!change.runs.empty()) mask.apply(change, Direction::forwards);
    }
    return mask;
}

std::string bytes_of(const Mask& mask)
{
    std::string bytes(size_t(mask.size().x * mask.size().y * mask.size().z), '\0');
    for (const int64_t brick : mask.painted_bricks()) {
        const VoxelBox box = mask.box_of(brick);
        const MaskBrick& groups = *mask.brick(brick);
        for (int64_t z = box.lower.z; z < box.upper.z; ++z)
            for (int64_t y = box.lower.y; y < box.upper.y; ++y) {
                const Size3 first(box.lower.x, y, z);
                std::copy_n(groups.begin() + int64_t(index_in_brick(first)), box.size().x,
                            bytes.begin() + index_of(first, mask.size()));
            }
    }
    return bytes;
}

/// A line of /proc/self/status such as "VmHWM:", in bytes; 0 where there is none.
int64_t memory(const std::string& name)
{
    std::ifstream file("/proc/self/status");
    const std::string status(std::istreambuf_iterator<char>(file), {});
    const size_t at = status.find(name);
    return at == std::string::npos ? 0 : 1024 * std::strtoll(status.c_str() + at + name.size(), nullptr, 10);
}

struct Cost {
    double seconds = 0.0, cpu_seconds = 0.0;
    int64_t peak_bytes = 0;  ///< above what was held before
};
template <class Do>
Cost cost_of(const Do& what)
{
    const auto cpu = [] {
        std::timespec now{};
        ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
        return double(now.tv_sec) + 1e-9 * double(now.tv_nsec);
    };
    if (std::FILE* const file = std::fopen("/proc/self/clear_refs", "w")) {  // the peak begins here
        std::fputs("5", file);
        std::fclose(file);
    }
    const int64_t held = memory("VmRSS:");
    const double cpu_before = cpu();
    const auto begin = std::chrono::steady_clock::now();
    what();
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    return {passed.count(), cpu() - cpu_before, memory("VmHWM:") - held};
}

void print(const Cost& cost, const std::string& found)
{
    std::printf(R"({"build": ")" SHVR_BUILD_TYPE R"(", "seconds": %.6f, "cpu_seconds": %.6f, "peak_bytes": %lld%s})"
                "\n",
                cost.seconds, cost.cpu_seconds, static_cast<long long>(cost.peak_bytes), found.c_str());
}

struct Options {
    std::string line, mask, volume, output;
    int64_t side = 0, memory = 0;
};

void measure_surfaces(const Options& options, const JsonNode& line)
{
    const Mask mask = mask_of(read_text(options.mask, int64_t{1} << 34), Size3(options.side));
    uint64_t triangles = 0, points = 0, cells = 0;
    double volume = 0.0;
    const Cost cost = cost_of([&] {
        GroupSurfaces surfaces(mask, {.steps = int(line["smooth"].whole(0, 1000)), .memory = uint64_t(options.memory)});
        points = surfaces.points();
        cells = surfaces.cells();
        for (int group = 1; group < 256; ++group) {
            surfaces.for_each_vertex(uint8_t(group), [](const glm::dvec3&) {});
            surfaces.for_each_triangle(uint8_t(group), [&](const glm::uvec3&, const std::array<glm::dvec3, 3>& at) {
                ++triangles;
                volume += glm::dot(at[0], glm::cross(at[1], at[2])) / 6.0;
            });
        }
    });
    print(cost, sentence(R"(, "triangles": )", triangles, R"(, "volume": )", volume, R"(, "points": )", points,
                         R"(, "bricks_read": )", cells));
}

GroupOperation operation_of(const JsonNode& line)
{
    return std::visit(
        [&]<class Op>(Op op) -> GroupOperation {
            if constexpr (IS_GROUP_OPERATION<Op>)
                return op;
            else
                line["op"].refuse("an operation on groups");
        },
        read_script_op(line));
}

/// The centre lines of group 1.
TraceGraph trace_of(const OperationInput& input)
{
    TraceGraph trace;
    for (const TraceChange& change : run(TraceFromMaskOp{}, input).trace_changes)
        trace.apply(change, Direction::forwards);
    return trace;
}

void measure_operation(const Options& options, const JsonNode& line)
{
    const GroupOperation operation = operation_of(line);
    const Size3 size(options.side);
    Mask mask = mask_of(read_text(options.mask, int64_t{1} << 34), size);
    const BytesSource source(options.volume.empty() ? std::string() : read_text(options.volume, int64_t{1} << 34),
                             size);
    OperationInput input{.mask = mask, .volume = source.info(), .source = &source, .memory = uint64_t(options.memory)};
    TraceGraph trace;
    if (std::holds_alternative<MaskFromTraceOp>(operation)) trace = trace_of(input);
    input.trace = &trace;
    OperationResult result;
    TraceGraph made;
    const Cost cost = cost_of([&] {
        result = run(operation, input);
        for (const MaskBrickChange& change : result.changes) mask.apply(change, Direction::forwards);
        for (const TraceChange& change : result.trace_changes) made.apply(change, Direction::forwards);
    });
    const Topology topology = topology_of(made);
    print(cost, sentence(R"(, "voxels": )", result.voxels, R"(, "bricks_read": )", result.bricks_read,
                         R"(, "bricks_written": )", result.bricks_written, R"(, "bricks_of_intensities": )",
                         result.bricks_of_intensities, R"(, "nodes": )", made.nodes().size(), R"(, "parts": )",
                         topology.components, R"(, "loops": )", topology.loops));
    if (options.output.empty()) return;
    std::FILE* const file = std::fopen(options.output.c_str(), "wb");
    const std::string bytes = bytes_of(mask);
    const bool is_written = file && std::fwrite(bytes.data(), 1, bytes.size(), file) == bytes.size();
    if (!file || std::fclose(file) != 0 || !is_written) fail(options.output, ": cannot be written");
}

}  // namespace

}  // namespace shvr

int main(int count, char** arguments)
{
    using namespace shvr;
    if (count != 7) {
        std::fprintf(stderr, "usage: shvr_operation_bench LINE SIDE MASK VOLUME|- BUDGET_MIB OUT|-\n");
        return 2;
    }
    try {
        const auto path = [](const char* text) { return std::string(text) == "-" ? std::string() : text; };
        const Options options{.line = arguments[1],
                              .mask = arguments[3],
                              .volume = path(arguments[4]),
                              .output = path(arguments[6]),
                              .side = whole_of(arguments[2]).value_or(0),
                              .memory = whole_of(arguments[5]).value_or(0) << 20};
        const JsonDocument line(options.line, "LINE");
        if (line.root()["op"].is("surfaces"))
            measure_surfaces(options, line.root());
        else
            measure_operation(options, line.root());
    } catch (const std::exception& error) {
        std::fprintf(stderr, "shvr_operation_bench: %s\n", error.what());
        return 1;
    }
    return 0;
}
