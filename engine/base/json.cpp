#include "engine/base/json.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include <nlohmann/json.hpp>

#include "engine/base/file.h"

namespace shvr {
namespace {

using nlohmann::json;

constexpr size_t MAX_QUOTE_BYTES = 60;
constexpr size_t MAX_REASON_BYTES = 200;
constexpr double MAX_WHOLE = 9007199254740992.0;  // 2^53: above it, doubles cannot represent every whole number

/// Shortens the text to at most MAX_QUOTE_BYTES bytes without cutting a UTF-8 character.
std::string shortened(std::string text)
{
    if (text.size() <= MAX_QUOTE_BYTES) return text;
    size_t end = MAX_QUOTE_BYTES - 3;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0u) == 0x80u) --end;
    return text.substr(0, end) + "...";
}

/// Returns the value as JSON on one line. JSON already escapes all control characters except DEL.
std::string shown(const json& value)
{
    std::string text = value.dump(-1, ' ', false, json::error_handler_t::replace);
    std::ranges::replace(text, '\x7f', '?');
    return text;
}

/// A key without its quotation marks.
std::string shown_key(const std::string& key)
{
    const std::string quoted = shown(key);
    return shortened(quoted.substr(1, quoted.size() - 2));
}

/// Returns the parser's message in printable ASCII (the parser quotes raw bytes), without its list of expected tokens.
std::string reason_of(const json::exception& error)
{
    std::string reason = error.what();
    if (const size_t bracket = reason.find("] "); bracket != std::string::npos) reason.erase(0, bracket + 2);
    reason = reason.substr(0, reason.find("; expected"));
    if (reason.size() > MAX_REASON_BYTES) reason = reason.substr(0, MAX_REASON_BYTES) + "...";
    std::ranges::replace_if(
        reason, [](char c) { return c < ' ' || c > '~'; }, '?');
    return reason;
}

/// Checks a text. Refuses invalid JSON, and two things that the parser accepts: deep nesting, and repeated keys (the
/// parser silently keeps the last one). This is a separate pass, because a parser with a callback searches a whole
/// array at the end of each of the array's elements.
class Strictness : public nlohmann::json_sax<json> {
public:
    Strictness(const std::string& origin, const JsonLimits& limits) : origin_(&origin), limits_(limits) {}

    bool null() override { return true; }
    bool boolean(bool) override { return true; }
    bool number_integer(number_integer_t) override { return true; }
    bool number_unsigned(number_unsigned_t) override { return true; }
    bool number_float(number_float_t, const string_t&) override { return true; }
    bool string(string_t&) override { return true; }
    bool binary(binary_t&) override { return true; }
    bool start_object(size_t) override { return enter(); }
    bool start_array(size_t) override { return enter(); }
    bool end_object() override { return leave(); }
    bool end_array() override { return leave(); }
    bool key(string_t& name) override
    {
        if (!keys_.back().insert(name).second && !limits_.may_repeat_keys)
            fail(*origin_, ": key ", shown_key(name), " appears twice in one object; expected once");
        return true;
    }
    bool parse_error(size_t, const std::string&, const json::exception& error) override
    {
        fail(*origin_, ": is not JSON: ", reason_of(error), "; expected ", limits_.expected);
    }

private:
    bool enter()
    {
        keys_.emplace_back();
        if (keys_.size() > size_t(limits_.depth))
            fail(*origin_, ": JSON nests deeper than ", limits_.depth, " levels; expected ", limits_.expected);
        return true;
    }
    bool leave()
    {
        keys_.pop_back();
        return true;
    }

    const std::string* origin_;
    JsonLimits limits_;
    std::vector<std::set<std::string>> keys_;  ///< one set per open level
};

std::string joined(const std::string& before, const std::string& name)
{
    return before.empty() ? name : before + "." + name;
}

/// Searches `value` (its key is `key`) and everything below it. Returns the full key of `wanted`, or null.
std::optional<std::string> key_below(const json& value, const json* wanted, const std::string& key)
{
    if (&value == wanted) return key;
    if (!value.is_structured()) return {};
    size_t index = 0;
    for (auto member = value.begin(); member != value.end(); ++member, ++index) {
        const std::string name = value.is_object() ? member.key() : std::to_string(index);
        if (auto found = key_below(*member, wanted, joined(key, name))) return found;
    }
    return {};
}

std::string list_of(std::span<const std::string_view> names, const char* quote)
{
    std::string list;
    for (const std::string_view name : names) list += sentence(list.empty() ? "" : ", ", quote, name, quote);
    return list;
}

}  // namespace

std::string NumberRange::sentence() const
{
    return expected.empty() ? shvr::sentence("a number from ", lower, " to ", upper) : expected;
}

NumberRange any_number()
{
    constexpr double LARGEST = std::numeric_limits<double>::max();
    return {-LARGEST, LARGEST, "a finite number"};
}

NumberRange above_zero(double lower, double upper)
{
    return {lower, upper, sentence("a number above 0 (", lower, " ... ", upper, ")")};
}

JsonDocument::JsonDocument(std::string_view text, std::string origin, const JsonLimits& limits)
    : origin_(std::move(origin))
{
    // The parser would treat a zero byte as the end of the text.
    if (const size_t zero = text.find('\0'); zero != std::string_view::npos)
        fail(origin_, ": is not JSON: byte ", zero + 1, " is zero; expected ", limits.expected);
    Strictness strictness(origin_, limits);
    json::sax_parse(text, &strictness);
    value_ = std::make_unique<json>(json::parse(text));
}

JsonDocument::JsonDocument(JsonDocument&&) noexcept = default;
JsonDocument::~JsonDocument() = default;

JsonDocument read_json(const std::filesystem::path& file, int64_t max_bytes, const JsonLimits& limits)
{
    return {read_text(file, max_bytes), file.string(), limits};
}

bool JsonNode::is_null() const
{
    return exists() && value_->is_null();
}
bool JsonNode::is_text() const
{
    return exists() && value_->is_string();
}
bool JsonNode::is_number() const
{
    return exists() && value_->is_number();
}
bool JsonNode::is_object() const
{
    return exists() && value_->is_object();
}
bool JsonNode::is_array() const
{
    return exists() && value_->is_array();
}
bool JsonNode::is(std::string_view text) const
{
    return is_text() && value_->get_ref<const std::string&>() == text;
}
size_t JsonNode::count() const
{
    return is_array() ? value_->size() : 0;
}
std::string JsonNode::dump() const
{
    return value_->dump();
}

std::string JsonNode::key() const
{
    const json* const there = exists() ? value_ : parent_;
    const std::string found = key_below(document_->value(), there, "").value_or("");
    return exists() ? found : joined(found, missing_);
}

std::string JsonNode::key_of(const std::string& name) const
{
    return shown_key(joined(key(), name));
}

std::string JsonNode::subject() const
{
    const std::string place = key();
    const bool is_root = place.empty() && value_ == &document_->value();
    return document_->origin() + (is_root ? ": the document" : ": key " + shown_key(place));
}

std::string JsonNode::refusal(const std::string& expected) const
{
    const std::string found = exists() ? "is " + shortened(shown(*value_)) : "is missing";
    return sentence(subject(), " ", found, "; expected ", expected);
}

void JsonNode::refuse_because(const std::string& reason) const
{
    fail(value_ == &document_->value() ? document_->origin() : subject(), ": ", reason);
}

void JsonNode::allow(std::span<const std::string_view> known) const
{
    if (!is_object()) refuse("an object with keys out of: " + list_of(known, ""));
    for (const auto& [name, value] : value_->items()) {
        if (std::ranges::find(known, name) == known.end())
            fail(document_->origin(), ": unknown key ", key_of(name), "; expected ",
                 known.size() == 1 ? "only " : "one of: ", list_of(known, ""));
    }
}

JsonNode JsonNode::operator[](std::string_view name) const
{
    JsonNode member(*document_, nullptr);
    if (is_object())
        if (const auto found = value_->find(std::string(name)); found != value_->end()) member.value_ = &*found;
    if (member.exists()) return member;
    member.parent_ = exists() ? value_ : parent_;
    member.missing_ = joined(missing_, std::string(name));
    return member;
}

JsonNode JsonNode::required(std::string_view name, const std::string& expected) const
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

std::vector<JsonNode> JsonNode::elements(size_t least, size_t most) const
{
    if (!is_array() || count() < least || count() > most) {
        const std::string found = is_array() ? sentence(", not of ", count()) : "";
        if (least == most) refuse(sentence("an array of ", least, found));
        if (most != SIZE_MAX) refuse(sentence("an array of ", least, " to ", most, found));
        refuse(least == 0 ? "an array" : sentence("an array of ", least, " or more", found));
    }
    std::vector<JsonNode> elements;
    elements.reserve(count());
    for (const json& element : *value_) elements.push_back({*document_, &element});
    return elements;
}

double JsonNode::number(const NumberRange& range) const
{
    if (is_number()) {
        const double value = value_->get<double>();
        if (value >= range.lower && value <= range.upper) return value;
    }
    refuse(range.sentence());
}

int64_t JsonNode::whole(int64_t lower, int64_t upper) const
{
    std::optional<int64_t> whole;
    if (exists() && value_->is_number_integer()) {
        // Numbers beyond int64_t are stored as unsigned.
        const bool fits = !value_->is_number_unsigned() || value_->get<uint64_t>() <= uint64_t{INT64_MAX};
        if (fits) whole = value_->get<int64_t>();
    } else if (is_number()) {
        const double value = value_->get<double>();
        if (value == std::floor(value) && std::abs(value) <= MAX_WHOLE) whole = int64_t(value);
    }
    if (whole && *whole >= lower && *whole <= upper) return *whole;
    refuse(lower == upper ? sentence(lower) : sentence("a whole number from ", lower, " to ", upper));
}

bool JsonNode::flag() const
{
    if (!exists() || !value_->is_boolean()) refuse("true or false");
    return value_->get<bool>();
}

std::string JsonNode::text(const std::string& expected) const
{
    if (!is_text() || is("")) refuse(expected);
    return value_->get<std::string>();
}

std::string JsonNode::any_text(const std::string& expected) const
{
    if (!is_text()) refuse(expected);
    return value_->get<std::string>();
}

glm::dvec3 JsonNode::vector(const NumberRange& range) const
{
    if (count() != 3) refuse("three numbers, [x, y, z]");
    const auto along = [&](size_t axis) { return JsonNode(*document_, &(*value_)[axis]).number(range); };
    return {along(0), along(1), along(2)};
}

glm::i64vec3 JsonNode::size(int64_t largest) const
{
    if (count() != 3) refuse("three whole numbers, [x, y, z]");
    const auto along = [&](size_t axis) { return JsonNode(*document_, &(*value_)[axis]).whole(1, largest); };
    return {along(0), along(1), along(2)};
}

size_t JsonNode::choice(std::span<const std::string_view> names) const
{
    for (size_t index = 0; index < names.size(); ++index)
        if (is(names[index])) return index;
    refuse("one of " + list_of(names, "\""));
}

}  // namespace shvr
