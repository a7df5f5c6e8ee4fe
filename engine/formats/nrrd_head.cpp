#include "engine/formats/nrrd_head.h"

#include <algorithm>
#include <map>
#include <utility>

#include "engine/base/text.h"
#include "engine/formats/header_fields.h"

namespace shvr {

namespace {

constexpr std::string_view SEGMENT = "Segment";
constexpr int64_t MAX_SEGMENTS = 1 << 20;

/// Undoes the escapes that NRRD uses for backslashes and line ends in keys and values.
std::string unescaped(std::string_view text)
{
    std::string plain;
    for (size_t at = 0; at < text.size(); ++at) {
        const char next = at + 1 < text.size() ? text[at + 1] : '\0';
        const bool is_escape = text[at] == '\\' && (next == 'n' || next == '\\');
        plain += !is_escape ? text[at] : next == 'n' ? '\n' : '\\';
        at += is_escape;
    }
    return plain;
}

std::string escaped(std::string_view text)
{
    std::string safe;
    for (const char character : text)
        if (character == '\\')
            safe += "\\\\";
        else if (character == '\n')
            safe += "\\n";
        else
            safe += character;
    return safe;
}

/// Splits "Segment3_Name" into its number and the rest, "Name"; null for other keys.
std::optional<std::pair<int64_t, std::string_view>> parts_of_key(std::string_view key)
{
    if (!key.starts_with(SEGMENT)) return std::nullopt;
    key.remove_prefix(SEGMENT.size());
    const size_t line = key.find('_');
    if (line == std::string_view::npos) return std::nullopt;
    const std::optional<int64_t> number = whole_of(key.substr(0, line));
    if (!number || *number < 0 || *number > MAX_SEGMENTS) return std::nullopt;
    return std::pair(*number, key.substr(line + 1));
}

void assign_groups(std::vector<NrrdSegment>& segments)
{
    int64_t last = 0;
    for (const NrrdSegment& segment : segments) last = std::max(last, segment.label_value);
    std::map<int64_t, int64_t> layers;                      // of each group
    std::map<std::pair<int64_t, int64_t>, int64_t> groups;  // by layer and label value
    for (NrrdSegment& segment : segments) {
        const auto [known, is_new] = groups.try_emplace({segment.layer, segment.label_value}, segment.label_value);
        if (is_new && !layers.try_emplace(segment.label_value, segment.layer).second) known->second = ++last;
        segment.group = known->second;
    }
}

}  // namespace

std::optional<NrrdHead> read_nrrd_head(const std::filesystem::path& path)
{
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(path, ignored) || !read_head(path, 4).starts_with("NRRD"))
        return std::nullopt;
    return nrrd_head_in(read_head(path));
}

std::optional<NrrdHead> nrrd_head_in(std::string_view text)
{
    std::string_view rest = text;
    const std::string_view magic = take_line(rest);
    if (magic.size() != 8 || !magic.starts_with("NRRD000") || magic[7] < '1' || magic[7] > '6') return std::nullopt;
    NrrdHead head{.version = magic[7] - '0'};
    while (!rest.empty()) {
        const std::string_view line = take_line(rest);
        if (line.empty()) break;
        const size_t colon = line.find(':');
        if (line.starts_with('#')) {
            head.comments.emplace_back(line);
        } else if (colon != std::string_view::npos && line.substr(colon).starts_with(":=")) {
            head.pairs.push_back({unescaped(line.substr(0, colon)), unescaped(line.substr(colon + 2))});
        } else if (colon != std::string_view::npos) {
            const std::string name = lower_case(trimmed(line.substr(0, colon)));
            head.fields.push_back({name, std::string(trimmed(line.substr(colon + 1)))});
            const bool names_files = name == "data file" || name == "datafile";
            if (names_files && head.fields.back().value.starts_with("LIST")) break;  // names follow
        }
    }
    return head;
}

std::string spelled(const NrrdPair& pair)
{
    return escaped(pair.key) + ":=" + escaped(pair.value);
}

std::vector<std::string> lines_of(const NrrdHead& head)
{
    std::vector<std::string> lines{sentence("NRRD000", head.version)};
    lines.insert(lines.end(), head.comments.begin(), head.comments.end());
    for (const NrrdPair& pair : head.pairs) lines.push_back(spelled(pair));
    for (const NrrdPair& field : head.fields) lines.push_back(field.key + ": " + field.value);  // a list ends them
    return lines;
}

void set_pair(std::vector<NrrdPair>& pairs, std::string_view key, std::string value)
{
    const auto found = std::ranges::find(pairs, key, &NrrdPair::key);
    if (found != pairs.end())
        found->value = std::move(value);
    else
        pairs.push_back({std::string(key), std::move(value)});
}

std::vector<NrrdSegment> segments_of(const NrrdHead& head)
{
    std::vector<NrrdSegment> segments;
    for (const NrrdPair& pair : head.pairs) {
        const auto key = parts_of_key(pair.key);
        if (!key) continue;
        auto found = std::ranges::find(segments, key->first, &NrrdSegment::number);
        if (found == segments.end())
            found = segments.insert(found, {.number = key->first, .label_value = key->first + 1});
        if (key->second == "Name") found->name = pair.value;
        if (key->second == "Color") found->color = pair.value;
        if (key->second == "LabelValue") found->label_value = whole_of(trimmed(pair.value)).value_or(0);
        if (key->second == "Layer") found->layer = whole_of(trimmed(pair.value)).value_or(0);
    }
    assign_groups(segments);
    return segments;
}

std::vector<NrrdPair> pairs_of(const NrrdHead& head, const NrrdSegment& segment)
{
    std::vector<NrrdPair> pairs;
    for (const NrrdPair& pair : head.pairs)
        if (const auto key = parts_of_key(pair.key); key && key->first == segment.number)
            pairs.push_back({std::string(key->second), pair.value});
    return pairs;
}

std::string segment_key(const NrrdSegment& segment, std::string_view name)
{
    return sentence(SEGMENT, segment.number, "_", name);
}

}  // namespace shvr
