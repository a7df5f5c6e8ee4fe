#include "haptics/hid_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "engine/base/error.h"
#include "engine/base/file.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr size_t MOST_PROFILE_BYTES = 16 << 10;  ///< four times what a layout takes
/// A profile has four. Printing JSON takes stack for each, so a message about 8000 would end the program.
constexpr int MOST_LEVELS = 8;
constexpr unsigned IN = 1, OUT = 2, FEATURE = 4;

struct QuantityName {
    std::string_view name;
    HidQuantity quantity;
    unsigned reports;  ///< where it may stand
};
constexpr std::array QUANTITY_NAMES{
    QuantityName{"buttons", HidQuantity::buttons, IN},
    QuantityName{"calibrated", HidQuantity::calibrated, IN},
    QuantityName{"time", HidQuantity::time, IN},
    QuantityName{"position_x", HidQuantity::position_x, IN},
    QuantityName{"position_y", HidQuantity::position_y, IN},
    QuantityName{"position_z", HidQuantity::position_z, IN},
    QuantityName{"rotation_w", HidQuantity::rotation_w, IN},
    QuantityName{"rotation_x", HidQuantity::rotation_x, IN},
    QuantityName{"rotation_y", HidQuantity::rotation_y, IN},
    QuantityName{"rotation_z", HidQuantity::rotation_z, IN},
    QuantityName{"force_sequence", HidQuantity::force_sequence, IN},
    QuantityName{"motor_temperature", HidQuantity::motor_temperature, IN},
    QuantityName{"sequence", HidQuantity::sequence, IN | OUT},
    QuantityName{"enable", HidQuantity::enable, OUT},
    QuantityName{"watchdog", HidQuantity::watchdog, OUT},
    QuantityName{"force_x", HidQuantity::force_x, OUT},
    QuantityName{"force_y", HidQuantity::force_y, OUT},
    QuantityName{"force_z", HidQuantity::force_z, OUT},
    QuantityName{"peak_force", HidQuantity::peak_force, FEATURE},
    QuantityName{"usable_x", HidQuantity::usable_x, FEATURE},
    QuantityName{"usable_y", HidQuantity::usable_y, FEATURE},
    QuantityName{"usable_z", HidQuantity::usable_z, FEATURE},
    QuantityName{"resolution", HidQuantity::resolution, FEATURE},
    QuantityName{"firmware", HidQuantity::firmware, FEATURE},
    QuantityName{"latency", HidQuantity::latency, FEATURE},
};

std::string_view name_of(HidQuantity quantity)
{
    for (const QuantityName& each : QUANTITY_NAMES) {
        if (each.quantity == quantity) return each.name;
    }
    return "?";
}

/// As a message shows it: on one line, in ASCII, at most 60 characters.
std::string shown(const Json& value)
{
    constexpr size_t LONGEST = 60;
    const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
    return text.size() <= LONGEST ? text : text.substr(0, LONGEST - 3) + "...";
}

/// A value and where it stands: "file: key input.fields.2.bits".
class Node {
public:
    Node(const Json& json, std::string origin, std::string key)
        : json_(json), origin_(std::move(origin)), key_(std::move(key))
    {}

    /// "... is VALUE; expected EXPECTATION"
    template <class... Parts>
    [[noreturn]] void refuse(const Parts&... expected) const
    {
        fail(origin_, ": ", key_.empty() ? "the document" : "key " + key_, " is ", shown(json_), "; expected ",
             expected...);
    }
    void allow(std::initializer_list<const char*> keys) const
    {
        if (!json_.is_object()) refuse("an object");
        for (const auto& [key, value] : json_.items()) {
            if (std::any_of(keys.begin(), keys.end(), [&, &k = key](const char* known) { return k == known; }))
                continue;
            std::string known;
            for (const char* each : keys) known += (known.empty() ? "" : ", ") + std::string(each);
            fail(origin_, ": unknown key ", shown(Json(key_.empty() ? key : key_ + "." + key)),
                 "; expected one of: ", known);
        }
    }
    bool has(const char* key) const { return json_.contains(key); }
    Node at(const char* key) const
    {
        const std::string whole = key_.empty() ? key : key_ + "." + key;
        if (!json_.contains(key)) fail(origin_, ": key ", whole, " is missing");
        return {json_.at(key), origin_, whole};
    }
    std::vector<Node> elements(size_t least) const
    {
        if (!json_.is_array() || json_.size() < least) refuse("a list of ", least, " or more");
        std::vector<Node> nodes;
        for (size_t i = 0; i < json_.size(); ++i) nodes.push_back({json_[i], origin_, key_ + "." + std::to_string(i)});
        return nodes;
    }

    std::string text() const
    {
        if (!json_.is_string() || json_.get<std::string>().empty()) refuse("a text");
        return json_.get<std::string>();
    }
    bool boolean() const
    {
        if (!json_.is_boolean()) refuse("true or false");
        return json_.get<bool>();
    }
    double number(double least, double most) const
    {
        if (!json_.is_number()) refuse("a number from ", least, " to ", most);
        const double value = json_.get<double>();
        if (!(value >= least && value <= most)) refuse("a number from ", least, " to ", most);
        return value;
    }
    uint32_t whole(uint32_t least, uint32_t most) const
    {
        if (!json_.is_number_integer()) refuse("a whole number from ", least, " to ", most);
        const bool is_large = json_.is_number_unsigned() && json_.get<uint64_t>() > most;
        if (is_large || json_.get<int64_t>() < int64_t(least) || json_.get<int64_t>() > int64_t(most))
            refuse("a whole number from ", least, " to ", most);
        return uint32_t(json_.get<int64_t>());
    }
    /// "0x1209": ids are written so everywhere else.
    uint16_t hexadecimal() const
    {
        const std::string value = json_.is_string() ? json_.get<std::string>() : "";
        const bool is_hexadecimal = value.size() == 6 && value.starts_with("0x") &&
                                    value.find_first_not_of("0123456789abcdefABCDEF", 2) == std::string::npos;
        if (!is_hexadecimal) refuse("four hexadecimal digits, as in \"0x1209\"");
        return uint16_t(std::stoul(value, nullptr, 16));
    }
    glm::dvec3 vector(double least, double most) const
    {
        const bool is_vector = json_.is_array() && json_.size() == 3;
        if (!is_vector) refuse("three numbers [x,y,z]");
        const std::vector<Node> nodes = elements(3);
        return {nodes[0].number(least, most), nodes[1].number(least, most), nodes[2].number(least, most)};
    }

private:
    const Json& json_;
    std::string origin_, key_;
};

HidQuantity read_quantity(const Node& node, unsigned report)
{
    const std::string name = node.text();
    std::string known;
    for (const QuantityName& each : QUANTITY_NAMES) {
        if (!(each.reports & report)) continue;
        if (each.name == name) return each.quantity;
        known += (known.empty() ? "" : ", ") + std::string(each.name);
    }
    node.refuse("one of: ", known);
}

HidField read_field(const Node& node, unsigned report, uint32_t length)
{
    node.allow({"name", "bit", "bits", "signed", "scale", "offset"});
    HidField field;
    field.quantity = read_quantity(node.at("name"), report);
    field.bit = node.at("bit").whole(0, 8 * length - 1);
    field.bits = node.at("bits").whole(1, 32);
    if (field.bit + field.bits > 8 * length)
        node.refuse("at most bit ", 8 * length - 1, ", the last of ", length, " bytes");
    if (node.has("signed")) field.is_signed = node.at("signed").boolean();
    if (node.has("scale")) field.scale = node.at("scale").number(-1e12, 1e12);
    if (node.has("offset")) field.offset = node.at("offset").number(-1e12, 1e12);
    if (std::abs(field.scale) < 1e-12) node.at("scale").refuse("a number other than 0");
    return field;
}

HidReport read_report(const Node& node, unsigned kind)
{
    node.allow({"id", "length", "fields"});
    HidReport report;
    report.id = uint8_t(node.at("id").whole(0, 255));
    report.length = node.at("length").whole(1, MOST_REPORT_BYTES);
    std::array<bool, 8 * MOST_REPORT_BYTES> taken{};
    for (const Node& each : node.at("fields").elements(1)) {
        const HidField field = read_field(each, kind, report.length);
        if (report.find(field.quantity)) each.at("name").refuse("each name once");
        for (uint32_t bit = field.bit; bit < field.bit + field.bits; ++bit) {
            if (std::exchange(taken[bit], true)) each.refuse("bits that no other field has; bit ", bit, " is taken");
        }
        report.fields.push_back(field);
    }
    return report;
}

void need(const Node& node, const HidReport& report, std::initializer_list<HidQuantity> quantities)
{
    for (const HidQuantity quantity : quantities) {
        if (!report.find(quantity)) node.at("fields").refuse("a field named ", name_of(quantity));
    }
}

void need_all_or_none(const Node& node, const HidReport& report, std::initializer_list<HidQuantity> quantities)
{
    if (std::any_of(quantities.begin(), quantities.end(), [&](HidQuantity q) { return report.find(q) != nullptr; }))
        need(node, report, quantities);
}

std::vector<HidMatch> read_matches(const Node& node)
{
    std::vector<HidMatch> matches;
    for (const Node& each : node.elements(1)) {
        each.allow({"vendor", "product", "usage_page", "usage"});
        HidMatch match{each.at("vendor").hexadecimal(), each.at("product").hexadecimal()};
        if (each.has("usage_page")) match.usage_page = each.at("usage_page").hexadecimal();
        if (each.has("usage")) match.usage = each.at("usage").hexadecimal();
        matches.push_back(match);
    }
    return matches;
}

/// Rows of a signed permutation: more would bend lengths, and forces would no longer oppose motions.
glm::dmat3 read_axes(const Node& node)
{
    const std::vector<Node> rows = node.elements(3);
    glm::dmat3 axes(0.0);
    if (rows.size() != 3) node.refuse("three rows");
    for (int row = 0; row < 3; ++row) {
        const glm::dvec3 values = rows[size_t(row)].vector(-1.0, 1.0);
        for (int column = 0; column < 3; ++column) axes[column][row] = values[column];
    }
    for (int i = 0; i < 3; ++i) {
        const glm::dvec3 column = glm::abs(axes[i]), row = glm::abs(glm::transpose(axes)[i]);
        const auto is_unit = [](const glm::dvec3& v) {
            return v.x + v.y + v.z == 1.0 && std::max({v.x, v.y, v.z}) == 1.0;
        };
        if (!is_unit(column) || !is_unit(row)) node.refuse("one 1 or -1 in each row and column");
    }
    return axes;
}

DeviceCaps read_limits(const Node& node)
{
    node.allow(
        {"usable_lower_m", "usable_upper_m", "peak_force_n", "continuous_force_n", "stiffness_limit", "latency_s"});
    DeviceCaps limits;
    limits.usable_lower_m = node.at("usable_lower_m").vector(-10.0, 10.0);
    limits.usable_upper_m = node.at("usable_upper_m").vector(-10.0, 10.0);
    if (!glm::all(glm::lessThan(limits.usable_lower_m, limits.usable_upper_m)))
        node.at("usable_upper_m").refuse("more than usable_lower_m along every axis");
    limits.peak_force_n = node.at("peak_force_n").number(0.0, 40.0);
    limits.continuous_force_n = node.at("continuous_force_n").number(0.0, limits.peak_force_n);
    limits.stiffness_limit = node.at("stiffness_limit").number(0.0, 5000.0);
    limits.latency_s = node.at("latency_s").number(0.0, 0.1);
    return limits;
}

HidProfile read_profile(const Node& node)
{
    using enum HidQuantity;
    node.allow({"name", "match", "input", "output", "feature", "axes", "limits", "watchdog_ms", "provenance",
                "verified", "note"});
    HidProfile profile;
    profile.name = node.at("name").text();
    profile.matches = read_matches(node.at("match"));
    profile.provenance = node.at("provenance").text();
    profile.verified = node.at("verified").boolean();
    if (node.has("note")) profile.note = node.at("note").text();
    if (node.has("axes")) profile.axes = read_axes(node.at("axes"));
    if (node.has("watchdog_ms")) profile.watchdog_ms = node.at("watchdog_ms").whole(0, 255);
    if (node.has("input") || node.has("limits")) profile.limits = read_limits(node.at("limits"));
    if (node.has("input")) {
        profile.input = read_report(node.at("input"), IN);
        need(node.at("input"), *profile.input, {position_x, position_y, position_z});
        need_all_or_none(node.at("input"), *profile.input, {rotation_w, rotation_x, rotation_y, rotation_z});
        profile.limits.senses_rotation = profile.input->find(rotation_w) != nullptr;
    }
    if (node.has("output")) {
        profile.output = read_report(node.at("output"), OUT);
        need(node.at("output"), *profile.output, {enable, force_x, force_y, force_z});
    }
    if (node.has("feature")) profile.feature = read_report(node.at("feature"), FEATURE);
    if (profile.verified && !profile.input) node.at("verified").refuse("false where there is no key input");
    return profile;
}

}  // namespace

const HidField* HidReport::find(HidQuantity quantity) const
{
    const auto found = std::ranges::find(fields, quantity, &HidField::quantity);
    return found == fields.end() ? nullptr : &*found;
}

HidProfile parse_hid_profile(const std::string& text, const std::string& origin)
{
    if (text.size() > MOST_PROFILE_BYTES)
        fail(origin, ": holds ", text.size(), " bytes; expected at most ", MOST_PROFILE_BYTES);
    Json document;
    try {
        document = Json::parse(text, [&](int depth, Json::parse_event_t, const Json&) {
            if (depth > MOST_LEVELS) fail(origin, ": is nested deeper than ", MOST_LEVELS, " levels; expected four");
            return true;
        });
    } catch (const Json::parse_error& error) {
        fail(origin, ": is not JSON from byte ", error.byte, " on; expected a device profile");
    } catch (const Json::out_of_range&) {
        fail(origin, ": holds a number too large to represent; expected numbers up to 1.8e308");
    }
    return read_profile(Node(document, origin, ""));
}

HidProfile load_hid_profile(const fs::path& file)
{
    return parse_hid_profile(read_text(file, int64_t{MOST_PROFILE_BYTES}), file.string());
}

std::vector<HidProfile> load_hid_profiles(const fs::path& folder)
{
    std::error_code error;
    std::vector<fs::path> files;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        if (entry->path().extension() == ".json") files.push_back(entry->path());
    }
    if (error) fail(folder.string(), ": cannot be listed: ", error.message(), "; expected a folder of device profiles");
    std::ranges::sort(files);
    std::vector<HidProfile> profiles;
    for (const fs::path& file : files) profiles.push_back(load_hid_profile(file));
    return profiles;
}

}  // namespace shvr
