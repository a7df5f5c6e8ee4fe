#pragma once
// Scripts of `shvr annotate`: one JSON object per line; blank lines and lines that start with // are skipped. The
// window makes the same structs from keys and menus, so menus, scripts and a stylus share one set of operations.

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "engine/annotation/brush.h"
#include "engine/annotation/operations/operations.h"
#include "engine/annotation/trace/trace_op.h"

namespace shvr {

struct UndoOp {
    int count = 1;
};
struct RedoOp {
    int count = 1;
};
struct SaveOp {};
/// Reverts to the last saved state.
struct RevertOp {};
struct ExpectOp {
    std::map<uint8_t, int64_t> voxels_in_group;
    std::optional<int64_t> voxels_with_offset{};
    std::optional<int64_t> nodes;
    std::optional<int64_t> internodes;
};

template <class Operations, class... Ops>
struct WithOperations;
template <class... Operations, class... Ops>
struct WithOperations<std::variant<Operations...>, Ops...> {
    using Type = std::variant<Ops..., Operations...>;
};
/// The operations on groups are added from their table (engine/annotation/operations).
using ScriptOp = WithOperations<GroupOperation, PaintOp, NodeOp, SelectOp, SelectSegmentOp, DeselectOp, LinkOp, MoveOp,
                                DeleteOp, GroupOp, RadiusOp, UndoOp, RedoOp, SaveOp, RevertOp, ExpectOp>::Type;

/// Whether the operation changes the work or writes files of the work.
bool changes_work(const ScriptOp& op);

struct ScriptLine {
    int number = 0;  ///< from 1
    ScriptOp op;
};

class JsonNode;

/// The names of operations, the more common ones first.
std::vector<std::string_view> script_op_names();
/// Parses a line whose key "op" must be one of `script_op_names`. Fails like `read_script`. `others`: operations that
/// the caller reads itself, and which the message about an unknown one lists, too.
ScriptOp read_script_op(const JsonNode& line, std::span<const std::string_view> others = {});
/// The line that parses as this operation.
std::string line_of(const ScriptOp& op);

/// Calls `take` with each non-empty line, of any operation, and its line number (from 1); both are valid only during
/// the call. "-" is standard input, which, like a pipe, is read to its end first. Fails if a line is not a JSON object.
void for_each_line(const std::filesystem::path& path,
                   const std::function<void(const JsonNode& line, int number)>& take);

/// Reads and checks the whole script before anything is run. Errors name file, line, key, value and expected value;
/// unknown keys and operations are refused.
std::vector<ScriptLine> read_script(const std::filesystem::path& path);
/// "standard input" for "-".
std::string name_of_script(const std::filesystem::path& path);

}  // namespace shvr
