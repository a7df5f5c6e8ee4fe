#include "engine/session/session_json.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <nlohmann/json.hpp>

#include "engine/look/session_color.h"
#include "engine/volume/grid.h"

namespace shvr {
namespace {

using nlohmann::json;

constexpr int DEEPEST_NESTING = 16;
constexpr size_t LONGEST_QUOTE = 60;
constexpr double LARGEST_WHOLE = 9007199254740992.0;  // 2^53: above it a double no longer tells neighbours apart

/// JSON escapes all control characters but the last one.
std::string printable(std::string text)
{
    std::ranges::replace(text, '\x7f', '?');
    return text;
}

/// At most LONGEST_QUOTE bytes, cut between characters of UTF-8.
std::string shortened(std::string text)
{
    if (text.size() <= LONGEST_QUOTE) return text;
    size_t end = LONGEST_QUOTE - 3;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
    return text.substr(0, end) + "...";
}

/// A key as a message may show it: control characters escaped.
std::string shown_key(const std::string& key)
{
    const std::string quoted = printable(json(key).dump());
    return quoted.substr(1, quoted.size() - 2);
}

/// Refuses what the parser itself lets pass: a key given twice, of which it would silently keep the last.
class Strictness {
public:
    explicit Strictness(const std::string& origin) : origin_(&origin) {}

    bool operator()(int depth, json::parse_event_t event, const json& parsed)
    {
        if (depth > DEEPEST_NESTING)
            fail(*origin_, ": JSON nests deeper than ", DEEPEST_NESTING, " levels; expected a session");
        if (event == json::parse_event_t::object_start) keys_.emplace_back();
        if (event == json::parse_event_t::object_end) keys_.pop_back();
        if (event == json::parse_event_t::key && !keys_.back().insert(parsed.get<std::string>()).second)
            fail(*origin_, ": key ", shown_key(parsed.get<std::string>()),
                 " appears twice in one object; expected once");
        return true;
    }

private:
    const std::string* origin_;
    std::vector<std::set<std::string>> keys_;
};

}  // namespace

json json_of(const std::string& text, const std::string& origin)
{
    try {
        return json::parse(text, Strictness(origin));
    } catch (const json::exception& error) {
        std::string reason = error.what();
        if (const size_t bracket = reason.find("] "); bracket != std::string::npos) reason.erase(0, bracket + 2);
        if (reason.size() > 200) reason = reason.substr(0, 200) + "...";
        fail(origin, ": is not JSON: ", printable(reason));
    }
}

bool JsonNode::is_text() const
{
    return exists() && value_->is_string();
}
bool JsonNode::is_object() const
{
    return exists() && value_->is_object();
}

std::string JsonNode::subject() const
{
    return key_.empty() ? *origin_ + ": the document" : *origin_ + ": key " + shown_key(key_);
}

void JsonNode::refuse(const std::string& expected) const
{
    if (!exists()) fail(subject(), " is missing; expected ", expected);
    fail(subject(), " is ", shortened(printable(value_->dump())), "; expected ", expected);
}

void JsonNode::refuse_because(const std::string& reason) const
{
    fail(subject(), ": ", reason);
}

void JsonNode::expect_object(std::initializer_list<const char*> known) const
{
    std::string list;
    for (const char* name : known) list += sentence(list.empty() ? "" : ", ", name);
    if (!is_object()) refuse("an object with keys out of: " + list);
    for (const auto& [name, value] : value_->items()) {
        if (std::ranges::find(known, name) == known.end())
            fail(*origin_, ": unknown key ", shown_key(key_of(name)), "; expected one of: ", list);
    }
}

JsonNode JsonNode::operator[](const std::string& name) const
{
    const json* member = nullptr;
    if (is_object()) {
        if (const auto found = value_->find(name); found != value_->end()) member = &*found;
    }
    return {member, key_of(name), origin_};
}

JsonNode JsonNode::required(const std::string& name, const std::string& expected) const
{
    JsonNode member = (*this)[name];
    if (!member.exists()) member.refuse(expected);
    return member;
}

std::vector<std::string> JsonNode::names() const
{
    if (!is_object()) refuse("an object");
    std::vector<std::string> names;
    for (const auto& [name, value] : value_->items()) names.push_back(name);
    return names;
}

std::vector<JsonNode> JsonNode::elements() const
{
    if (!exists() || !value_->is_array()) refuse("an array");
    std::vector<JsonNode> elements;
    for (size_t index = 0; index < value_->size(); ++index)
        elements.push_back({&(*value_)[index], key_of(std::to_string(index)), origin_});
    return elements;
}

double JsonNode::finite_number(const NumberRange& range) const
{
    if (value_->is_number()) {
        const double value = value_->get<double>();
        if (value >= range.lower && value <= range.upper) return value;
    }
    refuse(range.expected.empty() ? sentence("a number from ", range.lower, " to ", range.upper) : range.expected);
}

double JsonNode::number(double fallback, const NumberRange& range) const
{
    return exists() ? finite_number(range) : fallback;
}

int64_t JsonNode::whole(int64_t fallback, int64_t lower, int64_t upper) const
{
    if (!exists()) return fallback;
    const std::string expected = sentence("a whole number from ", lower, " to ", upper);
    const double value = finite_number({-LARGEST_WHOLE, LARGEST_WHOLE, expected});
    const auto whole = static_cast<int64_t>(value);
    if (value != std::floor(value) || whole < lower || whole > upper) refuse(expected);
    return whole;
}

bool JsonNode::flag(bool fallback) const
{
    if (!exists()) return fallback;
    if (!value_->is_boolean()) refuse("true or false");
    return value_->get<bool>();
}

std::string JsonNode::text(const std::string& fallback) const
{
    if (!exists()) return fallback;
    if (!is_text() || value_->get_ref<const std::string&>().empty()) refuse("a text that is not empty");
    return value_->get<std::string>();
}

glm::dvec3 JsonNode::vector(const glm::dvec3& fallback, const NumberRange& range) const
{
    if (!exists()) return fallback;
    if (!value_->is_array() || value_->size() != 3) refuse("three numbers, [x, y, z]");
    const std::vector<JsonNode> members = elements();
    glm::dvec3 vector;
    for (int axis = 0; axis < 3; ++axis) vector[axis] = members[static_cast<size_t>(axis)].finite_number(range);
    return vector;
}

Size3 JsonNode::size(const Size3& fallback) const
{
    if (!exists()) return fallback;
    if (!value_->is_array() || value_->size() != 3) refuse("three whole numbers, [x, y, z]");
    const std::vector<JsonNode> members = elements();
    Size3 size;
    for (int axis = 0; axis < 3; ++axis) size[axis] = members[static_cast<size_t>(axis)].whole(1, 1, int{LARGEST_SIDE});
    return size;
}

glm::dvec3 JsonNode::color(const glm::dvec3& fallback) const
{
    if (!exists()) return fallback;
    const std::string spelling = is_text() ? value_->get<std::string>() : std::string();
    const std::optional<glm::dvec4> color = spelling.size() == 7 ? color_of(spelling) : std::nullopt;
    if (!color) refuse("a colour, \"#rrggbb\"");
    return *color;
}

glm::dvec4 JsonNode::color_and_alpha(const glm::dvec4& fallback) const
{
    if (!exists()) return fallback;
    const std::optional<glm::dvec4> color = is_text() ? color_of(value_->get<std::string>()) : std::nullopt;
    if (!color) refuse("a colour, \"#rrggbb\" or \"#rrggbbaa\"");
    return *color;
}

}  // namespace shvr
