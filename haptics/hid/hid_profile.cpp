#include "haptics/hid/hid_profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

constexpr size_t MAX_PROFILE_BYTES = 16 << 10;  ///< four times the size of a typical layout
constexpr size_t MAX_INPUT_REPORTS = 8;
constexpr unsigned IN = 1, OUT = 2, FEATURE = 4;

struct QuantityName {
    std::string_view name;
    HidQuantity quantity;
    unsigned reports;  ///< reports that may contain it
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
    QuantityName{"rate_x", HidQuantity::rate_x, IN},
    QuantityName{"rate_y", HidQuantity::rate_y, IN},
    QuantityName{"rate_z", HidQuantity::rate_z, IN},
    QuantityName{"turn_x", HidQuantity::turn_x, IN},
    QuantityName{"turn_y", HidQuantity::turn_y, IN},
    QuantityName{"turn_z", HidQuantity::turn_z, IN},
    QuantityName{"battery", HidQuantity::battery, IN},
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

/// Reads an id such as "0x1209", the usual notation of USB ids.
uint16_t read_hexadecimal(const JsonNode& node)
{
    const auto parse = [](const std::string& text) -> std::optional<uint16_t> {
        const bool is_hexadecimal = text.size() == 6 && text.starts_with("0x") &&
                                    text.find_first_not_of("0123456789abcdefABCDEF", 2) == std::string::npos;
        if (!is_hexadecimal) return {};
        return uint16_t(std::stoul(text, nullptr, 16));
    };
    return node.parsed(parse, "four hexadecimal digits, as in \"0x1209\"");
}

HidQuantity read_quantity(const JsonNode& node, unsigned report)
{
    std::vector<std::string_view> names;
    std::vector<HidQuantity> quantities;
    for (const QuantityName& each : QUANTITY_NAMES) {
        if (!(each.reports & report)) continue;
        names.push_back(each.name);
        quantities.push_back(each.quantity);
    }
    return quantities[node.choice(names)];
}

HidField read_field(const JsonNode& node, unsigned report, uint32_t length)
{
    node.allow({"name", "bit", "bits", "signed", "scale", "offset"});
    HidField field;
    field.quantity = read_quantity(node["name"], report);
    field.bit = uint32_t(node["bit"].whole(0, 8 * length - 1));
    field.bits = uint32_t(node["bits"].whole(1, 32));
    if (field.bit + field.bits > 8 * length)
        node.refuse(sentence("at most bit ", 8 * length - 1, ", the last of ", length, " bytes"));
    if (node["signed"].exists()) field.is_signed = node["signed"].flag();
    if (node["scale"].exists()) field.scale = node["scale"].number({-1e12, 1e12});
    if (node["offset"].exists()) field.offset = node["offset"].number({-1e12, 1e12});
    if (std::abs(field.scale) < 1e-12) node["scale"].refuse("a number other than 0");
    return field;
}

HidReport read_report(const JsonNode& node, unsigned kind)
{
    node.allow({"id", "length", "fields"});
    HidReport report;
    report.id = uint8_t(node["id"].whole(0, 255));
    report.length = uint32_t(node["length"].whole(1, MAX_REPORT_BYTES));
    std::array<bool, 8 * MAX_REPORT_BYTES> taken{};
    for (const JsonNode& each : node["fields"].elements(1)) {
        const HidField field = read_field(each, kind, report.length);
        if (report.find(field.quantity)) each["name"].refuse("a name that no other field has");
        for (uint32_t bit = field.bit; bit < field.bit + field.bits; ++bit) {
            if (std::exchange(taken[bit], true))
                each.refuse(sentence("bits that no other field uses; bit ", bit, " is taken"));
        }
        report.fields.push_back(field);
    }
    return report;
}

void need(const JsonNode& node, const HidReport& report, std::initializer_list<HidQuantity> quantities)
{
    for (const HidQuantity quantity : quantities) {
        if (!report.find(quantity)) node["fields"].refuse(sentence("a field named ", name_of(quantity)));
    }
}

void need_all_or_none(const JsonNode& node, const HidReport& report, std::initializer_list<HidQuantity> quantities)
{
    if (std::any_of(quantities.begin(), quantities.end(), [&](HidQuantity q) { return report.find(q) != nullptr; }))
        need(node, report, quantities);
}

/// Reads several input reports. No two may share both id and length, and related fields must be in the same report.
std::vector<HidReport> read_inputs(const JsonNode& node)
{
    std::vector<HidReport> reports;
    for (const JsonNode& each : node.elements(1, int64_t{MAX_INPUT_REPORTS})) {
        const HidReport report = read_report(each, IN);
        for (const HidReport& other : reports) {
            if (other.id == report.id && other.length == report.length)
                each["id"].refuse("an id and a length that no other input report has");
            if ((other.id == 0) != (report.id == 0)) each["id"].refuse("ids above 0, or 0 in all input reports");
        }
        using enum HidQuantity;
        need_all_or_none(each, report, {position_x, position_y, position_z});
        need_all_or_none(each, report, {rotation_w, rotation_x, rotation_y, rotation_z});
        need_all_or_none(each, report, {rate_x, rate_y, rate_z});
        need_all_or_none(each, report, {turn_x, turn_y, turn_z});
        reports.push_back(report);
    }
    return reports;
}

HidRate read_rate(const JsonNode& node)
{
    node.allow({"speed_m_s", "turn_speed_rad_s", "gamma", "dead_zone", "rest_ms"});
    HidRate rate;
    rate.speed = node["speed_m_s"].number({0.0, 10.0});
    rate.turn_speed = node["turn_speed_rad_s"].number({0.0, 100.0});
    rate.gamma = node["gamma"].number({0.5, 5.0});
    rate.dead_zone = node["dead_zone"].number({0.0, 0.9});
    rate.rest_ms = uint32_t(node["rest_ms"].whole(20, 10'000));
    return rate;
}

std::vector<HidMatch> read_matches(const JsonNode& node)
{
    std::vector<HidMatch> matches;
    for (const JsonNode& each : node.elements(1)) {
        each.allow({"vendor", "product", "usage_page", "usage"});
        HidMatch match{read_hexadecimal(each["vendor"]), read_hexadecimal(each["product"])};
        if (each["usage_page"].exists()) match.usage_page = read_hexadecimal(each["usage_page"]);
        if (each["usage"].exists()) match.usage = read_hexadecimal(each["usage"]);
        matches.push_back(match);
    }
    return matches;
}

/// Reads a signed permutation matrix by rows. Other matrices could change lengths, and forces would not oppose motion.
glm::dmat3 read_axes(const JsonNode& node)
{
    const std::vector<JsonNode> rows = node.elements(3, 3);
    glm::dmat3 axes(0.0);
    for (int row = 0; row < 3; ++row) {
        const glm::dvec3 values = rows[size_t(row)].vector({-1.0, 1.0});
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

DeviceCaps read_limits(const JsonNode& node)
{
    node.allow(
        {"usable_lower_m", "usable_upper_m", "peak_force_n", "continuous_force_n", "stiffness_limit", "latency_s"});
    DeviceCaps limits;
    limits.usable_lower_m = node["usable_lower_m"].vector({-10.0, 10.0});
    limits.usable_upper_m = node["usable_upper_m"].vector({-10.0, 10.0});
    if (!glm::all(glm::lessThan(limits.usable_lower_m, limits.usable_upper_m)))
        node["usable_upper_m"].refuse("values greater than usable_lower_m along every axis");
    limits.peak_force_n = node["peak_force_n"].number({0.0, 40.0});
    limits.continuous_force_n = node["continuous_force_n"].number({0.0, limits.peak_force_n});
    limits.stiffness_limit = node["stiffness_limit"].number({0.0, 5000.0});
    limits.latency_s = node["latency_s"].number({0.0, 0.1});
    return limits;
}

/// Reads the additions of schema 2: reports to ignore, and rate control in place of positions.
void read_second(const JsonNode& node, HidProfile& profile)
{
    using enum HidQuantity;
    if (node["ignored_ids"].exists()) {
        for (const JsonNode& each : node["ignored_ids"].elements(1, 32)) {
            profile.ignored_ids.push_back(uint8_t(each.whole(1, 255)));
            if (std::ranges::find(profile.inputs, profile.ignored_ids.back(), &HidReport::id) != profile.inputs.end())
                each.refuse("an id that no input report has");
        }
    }
    const bool has_rates = profile.find_input(rate_x) || profile.find_input(turn_x);
    const bool has_places = profile.find_input(position_x) || profile.find_input(rotation_w);
    if (node["rate"].exists()) profile.rate = read_rate(node["rate"]);
    profile.limits.rate_control = profile.rate.has_value();
    if (profile.inputs.empty()) {
        if (profile.rate) node["rate"].refuse("no such key without the key inputs");
        return;
    }
    if (has_rates && !profile.rate) node["rate"].refuse("how fields named rate_ and turn_ become speeds");
    if (has_rates && has_places) node["inputs"].refuse("either places or rates");
    if (profile.rate && !profile.find_input(rate_x)) node["inputs"].refuse("a field named rate_x");
    if (!profile.rate && !profile.find_input(position_x)) node["inputs"].refuse("a field named position_x");
    if (profile.rate && node["output"].exists()) node["output"].refuse("no such key: rate control feels no force");
}

HidProfile read_profile(const JsonNode& node)
{
    using enum HidQuantity;
    const bool is_second = node["schema"].exists() && node["schema"].whole(1, 2) == 2;
    if (is_second)
        node.allow({"schema", "name", "match", "inputs", "ignored_ids", "rate", "output", "feature", "axes", "limits",
                    "watchdog_ms", "provenance", "verified", "note"});
    else
        node.allow({"schema", "name", "match", "input", "output", "feature", "axes", "limits", "watchdog_ms",
                    "provenance", "verified", "note"});
    const JsonNode inputs = node[is_second ? "inputs" : "input"];
    HidProfile profile;
    profile.name = node["name"].text();
    profile.matches = read_matches(node["match"]);
    profile.provenance = node["provenance"].text();
    profile.verified = node["verified"].flag();
    if (node["note"].exists()) profile.note = node["note"].text();
    if (node["axes"].exists()) profile.axes = read_axes(node["axes"]);
    if (node["watchdog_ms"].exists()) profile.watchdog_ms = uint32_t(node["watchdog_ms"].whole(0, 255));
    if (inputs.exists() || node["limits"].exists()) profile.limits = read_limits(node["limits"]);
    if (inputs.exists()) {
        profile.inputs = is_second ? read_inputs(inputs) : std::vector{read_report(inputs, IN)};
        if (!is_second) {
            need(inputs, profile.inputs[0], {position_x, position_y, position_z});
            need_all_or_none(inputs, profile.inputs[0], {rotation_w, rotation_x, rotation_y, rotation_z});
        }
        profile.limits.senses_rotation = profile.find_input(rotation_w) || profile.find_input(turn_x);
    }
    if (is_second) read_second(node, profile);
    if (node["output"].exists()) {
        profile.output = read_report(node["output"], OUT);
        need(node["output"], *profile.output, {enable, force_x, force_y, force_z});
    }
    if (node["feature"].exists()) profile.feature = read_report(node["feature"], FEATURE);
    if (profile.verified && profile.inputs.empty())
        node["verified"].refuse("false, because the profile has no key input");
    return profile;
}

}  // namespace

const HidField* HidReport::find(HidQuantity quantity) const
{
    const auto found = std::ranges::find(fields, quantity, &HidField::quantity);
    return found == fields.end() ? nullptr : &*found;
}

const HidField* HidProfile::find_input(HidQuantity quantity) const
{
    for (const HidReport& report : inputs) {
        if (const HidField* field = report.find(quantity)) return field;
    }
    return nullptr;
}

HidProfile parse_hid_profile(const std::string& text, const std::string& origin)
{
    if (text.size() > MAX_PROFILE_BYTES)
        fail(origin, ": holds ", text.size(), " bytes; expected at most ", MAX_PROFILE_BYTES);
    const JsonDocument document(text, origin, {.depth = 8, .expected = "a device profile"});
    return read_profile(document.root());
}

HidProfile load_hid_profile(const fs::path& file)
{
    return parse_hid_profile(read_text(file, int64_t{MAX_PROFILE_BYTES}), file.string());
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
