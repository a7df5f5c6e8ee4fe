#pragma once
// Regression pictures ("goldens") in a folder. Each has NAME.json, which names the session to draw, the expected
// NAME.png, and NAME.blessed.json, which records who drew it and why. README.md lists the keys. Plain data; any thread.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "engine/annotation/script/script.h"
#include "engine/base/image_metrics.h"
#include "engine/base/spelling.h"
#include "engine/session/session.h"

namespace shvr::golden {

/// How exactly a picture must match.
enum class Strictness {
    exact,  ///< the same bits
    tight,  ///< TIGHT_TOLERANCE: rounding of another driver or processor
    edge,   ///< tight, but EDGE_FRACTION of the pixels may differ by any amount: a silhouette off by a pixel
};
inline constexpr Spelling<Strictness> STRICTNESSES[] = {
    {Strictness::exact, "exact"}, {Strictness::tight, "tight"}, {Strictness::edge, "edge"}};
constexpr std::span<const Spelling<Strictness>> spellings_of(Strictness)
{
    return STRICTNESSES;
}
inline constexpr double EDGE_FRACTION = 0.003;

struct Golden {
    std::string name;
    std::filesystem::path folder;
    std::string why;       ///< what the picture guards
    std::string loosened;  ///< reason for the strictness `edge`; otherwise empty
    Strictness strictness = Strictness::tight;
    std::filesystem::path session_path;  ///< path of a session, project or volume file; empty: `session_text`
    std::string session_text;            ///< JSON; relative paths are relative to `folder`
    std::vector<std::string> settings;   ///< "key=value" on top of the session
    std::vector<ScriptLine> script;      ///< strokes, density strokes and undo

    std::filesystem::path file() const { return folder / (name + ".json"); }
    std::filesystem::path picture() const { return folder / (name + ".png"); }
    std::filesystem::path side_car() const { return folder / (name + ".blessed.json"); }
    /// Opens the volume and reads all of its voxels once, for statistics.
    OpenedSession open() const;
};

/// Reads the description of a golden. Fails with a sentence if the file does not conform to README.md.
Golden read_golden(const std::filesystem::path& file);
/// Returns the goldens in `folder` whose names match `pattern` ('*', 'tubes_*'), sorted by name. Fails if none match.
std::vector<Golden> goldens_in(const std::filesystem::path& folder, const std::string& pattern = "*");

/// Shell patterns: '*', '?', '[ab]'.
bool matches(const std::string& name, const std::string& pattern);

/// Returns why `actual` does not match `expected`: each exceeded limit, with the value found. Null if they match.
std::optional<std::string> why_different(const Image8& actual, const Image8& expected, Strictness strictness);

/// Returns the 64-bit FNV-1a hash of a picture's file as 16 digits. Detects accidents, not deliberate changes.
std::string hash_of(std::span<const std::byte> bytes);

}  // namespace shvr::golden
