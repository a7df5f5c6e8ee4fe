#include "tools/golden/golden.h"

#include <fnmatch.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "engine/base/json.h"

namespace shvr::golden {

namespace {

constexpr int64_t MAX_GOLDEN_BYTES = 1 << 20;

void read_script_lines(Golden& golden, const JsonNode& lines)
{
    int number = 0;
    for (const JsonNode& line : lines.elements()) {
        ScriptOp op = read_script_op(line);
        if (!std::holds_alternative<PaintOp>(op) && !std::holds_alternative<UndoOp>(op))
            line.refuse("paint, density or undo: pictures of goldens are painted and nothing else");
        golden.script.push_back({.number = ++number, .op = std::move(op)});
    }
}

/// Returns the largest difference among a pixel's channels between both pictures, in 8-bit levels.
int apart(const Image8& a, const Image8& b, size_t pixel)
{
    int most = 0;
    for (size_t channel = 4 * pixel; channel < 4 * pixel + 4; ++channel)
        most = std::max(most, std::abs(int(a.rgba[channel]) - int(b.rgba[channel])));
    return most;
}

/// Returns `actual` with the most different pixels (EDGE_FRACTION of all pixels) replaced by those of `expected`.
Image8 without_edges(Image8 actual, const Image8& expected)
{
    std::vector<std::pair<int, size_t>> differing;
    for (size_t pixel = 0; pixel < actual.rgba.size() / 4; ++pixel)
        if (const int levels = apart(actual, expected, pixel); levels > 0) differing.emplace_back(-levels, pixel);
    const auto most = size_t(EDGE_FRACTION * double(actual.rgba.size() / 4));
    std::sort(differing.begin(), differing.end());
    differing.resize(std::min(differing.size(), most));
    for (const auto& [levels, pixel] : differing)
        std::copy_n(expected.rgba.begin() + int64_t(4 * pixel), 4, actual.rgba.begin() + int64_t(4 * pixel));
    return actual;
}

}  // namespace

bool matches(const std::string& name, const std::string& pattern)
{
    return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
}

Golden read_golden(const std::filesystem::path& file)
{
    const JsonDocument document = read_json(file, MAX_GOLDEN_BYTES);
    const JsonNode root = document.root();
    root.allow({"why", "class", "loosened", "session", "script"});
    Golden golden{.name = file.stem().string(), .folder = file.parent_path()};
    golden.why = root.required("why", "what the picture watches over").text("what the picture watches over");
    golden.strictness = root["class"].choice_or(Strictness::tight);
    if (golden.strictness == Strictness::edge)
        golden.loosened =
            root.required("loosened", "why class edge and not tight").text("why class edge and not tight");
    else if (root["loosened"].exists())
        root["loosened"].refuse("nothing: only class edge is loosened");
    const JsonNode session = root.required("session", "a session, or the path of one");
    if (session.is_text())
        golden.session_path = golden.folder / session.text();
    else if (session.is_object())
        golden.session_text = session.dump();
    else
        session.refuse("a session (an object), or the path of a session, project or volume");
    if (root["script"].exists()) read_script_lines(golden, root["script"]);
    return golden;
}

OpenedSession Golden::open() const
{
    if (!session_path.empty()) return open_session(session_path, settings);
    OpenedSession opened;
    opened.session = parse_session(session_text, std::filesystem::absolute(folder), file().string(), settings);
    opened.source = open_source(opened.session);
    opened.statistics = measure(*opened.source);
    return opened;
}

std::vector<Golden> goldens_in(const std::filesystem::path& folder, const std::string& pattern)
{
    if (!std::filesystem::is_directory(folder))
        fail(folder.string(), " is no folder; expected one with a NAME.json for each picture (--folder)");
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        const std::filesystem::path& path = entry.path();
        if (path.extension() != ".json" || path.stem().extension() == ".blessed") continue;
        if (matches(path.stem().string(), pattern)) files.push_back(path);
    }
    if (files.empty())
        fail(folder.string(), " holds no NAME.json whose name matches '", pattern, "'; expected at least one golden");
    std::sort(files.begin(), files.end());
    std::vector<Golden> goldens;
    for (const std::filesystem::path& file : files) goldens.push_back(read_golden(file));
    return goldens;
}

std::optional<std::string> why_different(const Image8& actual, const Image8& expected, Strictness strictness)
{
    if (actual.width != expected.width || actual.height != expected.height)
        return sentence("the picture has ", actual.width, " x ", actual.height, " pixels; expected ", expected.width,
                        " x ", expected.height);
    switch (strictness) {
        case Strictness::exact: return why_not_within(compare_pixels(actual, expected), EXACT_TOLERANCE);
        case Strictness::tight: return why_not_within(compare_pixels(actual, expected), TIGHT_TOLERANCE);
        case Strictness::edge:
            return why_not_within(compare_pixels(without_edges(actual, expected), expected), TIGHT_TOLERANCE);
    }
    return std::nullopt;
}

std::string hash_of(std::span<const std::byte> bytes)
{
    uint64_t hash = 0xcbf29ce484222325u;
    for (const std::byte byte : bytes) hash = (hash ^ std::to_integer<uint64_t>(byte)) * 0x100000001b3u;
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

}  // namespace shvr::golden
