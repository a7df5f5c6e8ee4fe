#include "haptics/hid/hid_recording.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <string_view>

#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/json.h"

namespace shvr {
namespace {

using SteadyClock = std::chrono::steady_clock;

constexpr int READ_TIMEOUT = 20;  ///< ms
constexpr int64_t MAX_RECORDING_BYTES = 256 << 20;
constexpr std::string_view DIGITS = "0123456789abcdef";

void append_hexadecimal(std::string& text, const std::vector<uint8_t>& bytes)
{
    for (const uint8_t byte : bytes) {
        text += DIGITS[byte >> 4];
        text += DIGITS[byte & 15];
    }
}

std::string hexadecimal_id(uint16_t id)
{
    std::string text = "0x";
    append_hexadecimal(text, {uint8_t(id >> 8), uint8_t(id)});
    return text;
}

std::optional<std::vector<uint8_t>> bytes_of_text(const std::string& text, size_t most)
{
    if (text.size() % 2 != 0 || text.size() / 2 > most) return {};
    std::vector<uint8_t> bytes;
    for (size_t at = 0; at < text.size(); at += 2) {
        const size_t high = DIGITS.find(text[at]), low = DIGITS.find(text[at + 1]);
        if (high == std::string_view::npos || low == std::string_view::npos) return {};
        bytes.push_back(uint8_t(high << 4 | low));
    }
    return bytes;
}

std::vector<uint8_t> read_bytes(const JsonNode& node, size_t most)
{
    const auto parse = [&](const std::string& text) { return bytes_of_text(text, most); };
    return node.parsed(parse, sentence("an even number of hexadecimal digits, at most ", 2 * most));
}

uint16_t read_id(const JsonNode& node)
{
    const auto parse = [](const std::string& text) -> std::optional<uint16_t> {
        const auto bytes = text.starts_with("0x") ? bytes_of_text(text.substr(2), 2) : std::nullopt;
        if (!bytes || bytes->size() != 2) return {};
        return uint16_t((*bytes)[0] << 8 | (*bytes)[1]);
    };
    return node.parsed(parse, "four hexadecimal digits, as in \"0x2988\"");
}

/// Escapes the quotation mark and the backslash: JSON forbids no other printable ASCII characters in a string.
std::string quoted(const std::string& text)
{
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += uint8_t(c) < 0x20 || uint8_t(c) >= 0x7f ? '?' : c;
    }
    return result + '"';
}

void read_head(const JsonNode& node, HidRecording& recording)
{
    node.allow({"format", "version", "vendor", "product", "name", "descriptor"});
    const std::vector<std::string_view> formats{"shvr_hid_reports"};
    node["format"].choice(formats);
    node["version"].whole(1, 1);
    recording.vendor = read_id(node["vendor"]);
    recording.product = read_id(node["product"]);
    if (!node["name"].is("")) recording.name = node["name"].text();
    recording.descriptor = read_bytes(node["descriptor"], 4096);
}

HidRecordedReport read_recorded(const JsonNode& node, uint64_t earliest_us)
{
    node.allow({"t_us", "bytes"});
    HidRecordedReport report;
    report.t_us = uint64_t(node["t_us"].whole(0, int64_t{1} << 52));
    if (report.t_us < earliest_us) node["t_us"].refuse(sentence("at least ", earliest_us, ", the time before it"));
    report.bytes = read_bytes(node["bytes"], MAX_RECORDED_REPORT_BYTES);
    return report;
}

}  // namespace

bool record_reports(HidPort& port, double most_s, const std::function<bool(size_t)>& goes_on, HidRecording& recording)
{
    const SteadyClock::time_point start = SteadyClock::now();
    const auto passed_us = [&] {
        return uint64_t(std::chrono::duration_cast<std::chrono::microseconds>(SteadyClock::now() - start).count());
    };
    const uint64_t before_us = recording.reports.empty() ? 0 : recording.reports.back().t_us;
    uint64_t asked_us = 0;
    std::array<uint8_t, MAX_RECORDED_REPORT_BYTES> bytes{};
    while (double(passed_us()) < most_s * 1e6 && recording.reports.size() < MAX_RECORDED_REPORTS) {
        const int size = port.read(bytes, READ_TIMEOUT);
        if (size < 0) return false;
        if (size > 0) recording.reports.push_back({before_us + passed_us(), {bytes.begin(), bytes.begin() + size}});
        if (passed_us() - asked_us < uint64_t{READ_TIMEOUT} * 1000) continue;
        asked_us = passed_us();
        if (!goes_on(recording.reports.size())) break;
    }
    return true;
}

std::string text_of(const HidRecording& recording)
{
    std::string text = sentence(R"({"format":"shvr_hid_reports","version":1,"vendor":")",
                                hexadecimal_id(recording.vendor), R"(","product":")", hexadecimal_id(recording.product),
                                R"(","name":)", quoted(recording.name), R"(,"descriptor":")");
    append_hexadecimal(text, recording.descriptor);
    text += "\"}\n";
    for (const HidRecordedReport& report : recording.reports) {
        text += sentence(R"({"t_us":)", report.t_us, R"(,"bytes":")");
        append_hexadecimal(text, report.bytes);
        text += "\"}\n";
    }
    return text;
}

HidRecording parse_hid_recording(const std::string& text, const std::string& origin)
{
    HidRecording recording;
    size_t line = 0;
    for (size_t at = 0; at < text.size();) {
        const size_t end = std::min(text.find('\n', at), text.size());
        const JsonDocument document(text.substr(at, end - at), sentence(origin, ":", ++line),
                                    {.depth = 2, .expected = "a line of recorded reports"});
        at = end + 1;
        if (line == 1) {
            read_head(document.root(), recording);
            continue;
        }
        if (recording.reports.size() == MAX_RECORDED_REPORTS)
            fail(origin, ": holds more than ", MAX_RECORDED_REPORTS, " reports; expected at most so many");
        const uint64_t earliest_us = recording.reports.empty() ? 0 : recording.reports.back().t_us;
        recording.reports.push_back(read_recorded(document.root(), earliest_us));
    }
    if (line == 0) fail(origin, ": is empty; expected a line about the device and one for each report");
    return recording;
}

HidRecording load_hid_recording(const std::filesystem::path& file)
{
    return parse_hid_recording(read_text(file, MAX_RECORDING_BYTES), file.string());
}

}  // namespace shvr
