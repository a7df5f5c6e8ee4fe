#include "engine/workbench/actions/action_rows.h"

#include <algorithm>
#include <array>

#include "engine/annotation/script/log_time.h"
#include "engine/base/text.h"
#include "engine/session/fields.h"
#include "engine/session/session_patch.h"
#include "engine/workbench/models/hand_view.h"
#include "engine/workbench/models/preferences.h"

namespace shvr::ui {

namespace {

constexpr ActionRows TABLE =
    std::tuple_cat(LOOKING_ACTIONS, SETTINGS_ACTIONS, LOOK_ACTIONS, PROBE_ACTIONS, PAINTING_ACTIONS, GROUP_ACTIONS,
                   TRACING_ACTIONS, MEASURING_ACTIONS, WORK_ACTIONS, PICTURE_ACTIONS, WINDOW_ACTIONS, HAND_ACTIONS);

constexpr auto ROWS =
    std::apply([](const auto&... rows) { return std::array{static_cast<const ActionRow&>(rows)...}; }, TABLE);

/// The row of a kind of action.
template <class Kind>
constexpr const auto& full_row()
{
    return std::get<INDEX_OF_KIND<Kind>>(TABLE);
}

// ---- Between actions and lines --------------------------------------------------------------------------------------

template <class Kind>
constexpr bool IS_SCRIPT_OP = std::is_constructible_v<ScriptOp, Kind>;

/// Returns a function that visits the key "op", which holds the action's id, and then the action's arguments.
Fields::Visit with_op(std::string& op, const Fields::Visit& arguments)
{
    return [&op, arguments](Fields& f) {
        f.text("op", op, {.is_required = true});
        f.retired("time");  // of a log's lines: replays ignore it
        arguments(f);
    };
}

/// Returns the action whose struct has the index `index` in the tables, with the arguments read from the line.
template <size_t INDEX = 0>
Action read_kind(size_t index, std::string& id, const JsonNode& line)
{
    if constexpr (INDEX + 1 < std::tuple_size_v<ActionRows>)
        if (index != INDEX) return read_kind<INDEX + 1>(index, id, line);
    typename std::tuple_element_t<INDEX, ActionRows>::Kind kind{};
    if constexpr (!IS_SCRIPT_OP<decltype(kind)>)
        read_fields(line, {}, with_op(id, [&](Fields& f) { std::get<INDEX>(TABLE).fields(f, kind); }));
    return kind;
}

/// Returns the ids of all actions and the names of all operations of scripts, without duplicates.
std::vector<std::string_view> known_ids()
{
    std::vector<std::string_view> ids;
    for (const ActionRow& row : ROWS) ids.push_back(row.id);
    for (const std::string_view name : script_op_names())
        if (std::ranges::find(ids, name) == ids.end() && name != "expect") ids.push_back(name);
    return ids;
}

Action of_script(const ScriptOp& op, const JsonNode& line)
{
    return std::visit(
        [&]<class Op>(const Op& each) -> Action {
            if constexpr (std::is_constructible_v<Action, Op>)
                return each;
            else
                line["op"].refuse("an action");
        },
        op);
}

const JsonLimits LINE{.depth = 16, .expected = "an action"};

/// Splits at spaces that are not inside quotes.
std::vector<std::string> parts_of(const std::string& text)
{
    std::vector<std::string> words{""};
    bool is_quoted = false, is_escaped = false;
    for (const char c : text) {
        is_quoted ^= c == '"' && !is_escaped;
        is_escaped = c == '\\' && !is_escaped;
        if (c == ' ' && !is_quoted)
            words.emplace_back();
        else
            words.back() += c;
    }
    std::erase(words, "");
    return words;
}

std::string quoted(const std::string& text)
{
    std::string escaped;
    for (const char c : text) escaped += c == '"' || c == '\\' ? std::string{'\\', c} : std::string(1, c);
    return '"' + escaped + '"';
}

bool is_json(const std::string& text)
{
    try {
        return JsonDocument(text, "", LINE).root().exists();
    } catch (const Error&) {
        return false;
    }
}

}  // namespace

std::span<const ActionRow> action_rows()
{
    return ROWS;
}

const ActionRow& row_of(const Action& action)
{
    return ROWS[action.index()];
}

std::string line_of(const Action& action)
{
    return action.visit([&]<class Kind>(Kind kind) -> std::string {
        if constexpr (IS_SCRIPT_OP<Kind>) {
            return line_of(ScriptOp(kind));
        } else {
            std::string id = row_of(action).id;
            return write_fields({}, with_op(id, [&](Fields& f) { full_row<Kind>().fields(f, kind); }));
        }
    });
}

std::string with_present_time(const std::string& line)
{
    return with_time(line, wall_clock_ms());
}

Action read_action(const JsonNode& line)
{
    if (!line.is_object()) line.refuse("an object such as {\"op\":\"save\"}");
    const std::vector<std::string_view> ids = known_ids();
    std::string id(ids[line["op"].choice(ids)]);
    const auto names = script_op_names();
    if (std::ranges::find(names, id) != names.end()) return of_script(read_script_op(line), line);
    const auto row = std::ranges::find_if(ROWS, [&](const ActionRow& each) { return each.id == id; });
    return read_kind(size_t(row - std::begin(ROWS)), id, line);
}

Action read_action(std::string_view line, const std::string& origin)
{
    const JsonDocument document(line, origin, LINE);
    return read_action(document.root());
}

std::string text_of(const Action& action)
{
    const JsonDocument document(line_of(action), "action", LINE);
    std::string text = document.root()["op"].any_text();
    for (const std::string& key : document.root().names())
        if (key != "op") text += " " + key + "=" + document.root()[key].dump();
    return text;
}

Action action_of_text(const std::string& text)
{
    const std::vector<std::string> parts = parts_of(text);
    if (parts.empty()) fail("the action is empty; expected one such as: orbit right_degrees=3");
    std::string line = sentence("{\"op\":", quoted(parts.front()));
    for (const std::string& part : std::span(parts).subspan(1)) {
        const size_t equals = part.find('=');
        if (equals == std::string::npos || equals == 0)
            fail("action ", parts.front(), ": '", part, "' is no argument; expected key=value");
        const std::string value = part.substr(equals + 1);
        line += sentence(',', quoted(part.substr(0, equals)), ':', is_json(value) ? value : quoted(value));
    }
    return read_action(line + "}", "action");
}

bool waits_for_strokes(const Model& model, const Action& action)
{
    return model.is_painting && !model.stroke_is_open && why_not(model, action) == IS_PAINTING;
}

std::string why_not(const Model& model, const Action& action)
{
    return action.visit([&]<class Kind>(const Kind& kind) -> std::string {
        if (full_row<Kind>().needs == Needs::document && !model.is_open) return "nothing is open";
        return full_row<Kind>().why_not(model, kind);
    });
}

}  // namespace shvr::ui
