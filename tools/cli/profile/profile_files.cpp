#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cerrno>
#include <iomanip>
#include <sstream>

#include "engine/base/atomic_file.h"
#include "engine/base/file.h"
#include "engine/graph/graph_text.h"
#include "tools/cli/profile/profile_report.h"
#include "tools/cli/profile/temporary_folder.h"

extern char** environ;

namespace shvr::cli {

namespace {

constexpr int HOST = 1, DEVICE = 2;  // "processes" of the trace
constexpr int64_t MAX_GRAPH_BYTES = int64_t(64) << 20;

double microseconds(double milliseconds)
{
    return milliseconds * 1000.0;
}

Json name_event(const char* kind, int process, int thread, const std::string& name)
{
    return {{"ph", "M"}, {"name", kind}, {"pid", process}, {"tid", thread}, {"args", {{"name", name}}}};
}

Json span_event(const std::string& name, int process, size_t thread, double begin_ms, double length_ms, Json args)
{
    return {{"ph", "X"},
            {"name", name},
            {"cat", process == DEVICE ? "pass" : "frame"},
            {"pid", process},
            {"tid", thread},
            {"ts", microseconds(begin_ms)},
            {"dur", microseconds(length_ms)},
            {"args", std::move(args)}};
}

void add_pass(Json& events, const Profile& profile, const PlacedPass& placed)
{
    const gpu::PassReport& pass = profile.frames[placed.frame].passes[placed.pass];
    const size_t lane = placed.lane + 1;
    events.push_back(span_event(pass.name, DEVICE, lane, placed.begin_ms, pass.gpu_ms,
                                {{"frame", placed.frame},
                                 {"kernel", pass.kernel},
                                 {"dispatches", pass.dispatches},
                                 {"bytes", pass.bytes},
                                 {"barrier", pass.barrier}}));
    if (placed.is_first)
        events.push_back({{"ph", "f"},
                          {"bp", "e"},
                          {"name", "submit"},
                          {"cat", "submit"},
                          {"id", placed.frame},
                          {"pid", DEVICE},
                          {"tid", lane},
                          {"ts", microseconds(placed.begin_ms)}});
}

void add_frame(Json& events, const Profile& profile, const ProfiledFrame& frame, size_t index)
{
    const double begin_us = microseconds(frame.begin_ms);
    events.push_back(span_event(sentence("frame ", index), HOST, 1, frame.begin_ms, frame.end_ms - frame.begin_ms,
                                {{"submit_to_done_ms", frame.wall_ms}}));
    const std::vector<std::pair<double, double>> recorded = recorded_in(profile, frame);
    for (size_t i = 0; i < recorded.size(); ++i)
        events.push_back(span_event("record " + frame.passes[i].name, HOST, 1, recorded[i].first, recorded[i].second,
                                    {{"frame", index}}));
    events.push_back({{"ph", "s"},
                      {"name", "submit"},
                      {"cat", "submit"},
                      {"id", index},
                      {"pid", HOST},
                      {"tid", 1},
                      {"ts", begin_us}});
    double sum = 0.0;
    for (const gpu::PassReport& pass : frame.passes) sum += pass.gpu_ms;
    events.push_back({{"ph", "C"},
                      {"name", "milliseconds"},
                      {"pid", HOST},
                      {"ts", begin_us},
                      {"args", {{"frame", frame.wall_ms}, {"sum of passes", sum}}}});
    events.push_back({{"ph", "C"},
                      {"name", "device memory"},
                      {"pid", DEVICE},
                      {"ts", begin_us},
                      {"args", {{"bytes", frame.device_bytes}}}});
}

/// Returns a field of a CSV table, in quotes where RFC 4180 requires them.
std::string field(const std::string& text)
{
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string svg_of(const std::string& graphviz)
{
    const TemporaryFolder folder("shvr-graph");
    std::string input = (folder.path / "graph.dot").string(), output = (folder.path / "graph.svg").string();
    write_text(input, graphviz);
    std::string program = "dot", format = "-Tsvg", option = "-o";
    char* const arguments[] = {program.data(), format.data(), option.data(), output.data(), input.data(), nullptr};
    pid_t process = 0;
    const int error = ::posix_spawnp(&process, "dot", nullptr, nullptr, arguments, environ);
    if (error != 0)
        fail("the program dot cannot be started: ", reason_of(error),
             "; expected Graphviz, or --graph with the extension .dot or .json");
    int status = 0;
    while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
    }
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        fail("the program dot failed with status ", WIFEXITED(status) ? WEXITSTATUS(status) : status, "; expected 0");
    return read_text(output, MAX_GRAPH_BYTES);
}

}  // namespace

std::vector<std::pair<double, double>> recorded_in(const Profile& profile, const ProfiledFrame& frame)
{
    std::vector<std::pair<double, double>> spans;
    double end = frame.begin_ms;
    for (const gpu::PassReport& pass : frame.passes) {
        const std::chrono::duration<double, std::milli> since = pass.recorded - profile.measured_from;
        const double begin = std::clamp(since.count(), end, frame.end_ms);
        end = std::min(begin + pass.record_ms, frame.end_ms);
        spans.emplace_back(begin, end - begin);
    }
    return spans;
}

std::vector<PlacedPass> placed_passes(const Profile& profile)
{
    std::vector<PlacedPass> placed;
    std::vector<double> free_from;  // time from which each lane is free, since spans of a lane must not overlap
    for (size_t index = 0; index < profile.frames.size(); ++index) {
        const ProfiledFrame& frame = profile.frames[index];
        const double busy_until = free_from.empty() ? 0.0 : *std::max_element(free_from.begin(), free_from.end());
        const double origin = std::max({busy_until, frame.begin_ms, frame.end_ms - frame.wall_ms});
        bool is_first = true;
        for (size_t i = 0; i < frame.passes.size(); ++i) {
            const gpu::PassReport& pass = frame.passes[i];
            if (!pass.timed) continue;
            const double begin = origin + pass.start_ms;
            size_t lane = 0;
            while (lane < free_from.size() && free_from[lane] > begin) ++lane;
            free_from.resize(std::max(free_from.size(), lane + 1));
            free_from[lane] = begin + pass.gpu_ms;
            placed.push_back({index, i, begin, lane, std::exchange(is_first, false)});
        }
    }
    return placed;
}

std::string trace_of(const Profile& profile)
{
    Json spans = Json::array();
    for (size_t i = 0; i < profile.frames.size(); ++i) add_frame(spans, profile, profile.frames[i], i);
    size_t lanes = 0;
    for (const PlacedPass& placed : placed_passes(profile)) {
        add_pass(spans, profile, placed);
        lanes = std::max(lanes, placed.lane + 1);
    }
    std::stable_sort(spans.begin(), spans.end(),
                     [](const Json& a, const Json& b) { return a["ts"].get<double>() < b["ts"].get<double>(); });
    Json events = Json::array({name_event("process_name", HOST, 1, "CPU"), name_event("thread_name", HOST, 1, "frames"),
                               name_event("process_name", DEVICE, 1, "GPU: " + profile.device)});
    for (size_t lane = 1; lane <= lanes; ++lane)
        events.push_back(name_event("thread_name", DEVICE, int(lane), sentence("passes ", lane)));
    for (Json& span : spans) events.push_back(std::move(span));
    const Json trace = {{"traceEvents", events},
                        {"displayTimeUnit", "ms"},
                        {"otherData",
                         {{"input", profile.input},
                          {"device", profile.device},
                          {"driver", profile.driver},
                          {"serialize", profile.serialize},
                          {"counters", counters_of(profile.counted)}}}};
    return trace.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string csv_of(const Profile& profile)
{
    std::ostringstream text;
    text << "frame,step,pass,kernel,start_ms,gpu_ms,dispatches,bytes,barrier,frame_ms,record_ms\n";
    text << std::setprecision(9);
    for (size_t i = 0; i < profile.frames.size(); ++i)
        for (size_t step = 0; step < profile.frames[i].passes.size(); ++step) {
            const gpu::PassReport& pass = profile.frames[i].passes[step];
            text << i << ',' << step << ',' << field(pass.name) << ',' << field(pass.kernel) << ',';
            if (pass.timed)
                text << pass.start_ms << ',' << pass.gpu_ms;
            else
                text << ',';
            text << ',' << pass.dispatches << ',' << pass.bytes << ',' << field(pass.barrier) << ','
                 << profile.frames[i].wall_ms << ',' << pass.record_ms << '\n';
        }
    return text.str();
}

void write_graph(const std::filesystem::path& path, const FrameGraph& graph)
{
    const CompiledGraph compiled = graph.compile();
    if (path.extension() == ".json") return write_text(path, to_json_text(graph, compiled));
    const std::string graphviz = to_graphviz(graph, compiled);
    write_text(path, path.extension() == ".svg" ? svg_of(graphviz) : graphviz);
}

void write_text(const std::filesystem::path& path, const std::string& text)
{
    write_file_atomically(path, std::as_bytes(std::span(text)));
}

}  // namespace shvr::cli
