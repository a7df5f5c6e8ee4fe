#include "engine/formats/data_files.h"

#include <algorithm>
#include <cctype>

#include "engine/base/error.h"
#include "engine/formats/choice.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

/// Bounds memory and time: each file costs about a hundred bytes for its name, and one lookup in the file system.
constexpr int64_t MAX_FILES = 65536;

/// A file name pattern with one printf conversion (%d, %3d or %03d), split at the conversion. The pattern is untrusted,
/// so it is never passed to printf.
struct Pattern {
    std::string before{}, after{};
    size_t width = 0;
    bool has_zeros = false;

    std::string name_of(int64_t number) const
    {
        const std::string digits = std::to_string(number);
        const std::string fill(width > digits.size() ? width - digits.size() : 0, has_zeros ? '0' : ' ');
        return before + fill + digits + after;
    }
};

Pattern parse_pattern(const HeaderFields& fields, const char* field, std::string_view text)
{
    constexpr size_t WIDEST = 32;
    Pattern pattern;
    bool has_number = false;
    for (size_t at = 0; at < text.size(); ++at) {
        std::string& part = has_number ? pattern.after : pattern.before;
        if (text[at] != '%') {
            part += text[at];
            continue;
        }
        if (text.substr(at + 1).starts_with('%')) {
            part += text[at++];
            continue;
        }
        const size_t letter = std::min(text.size(), text.find_first_not_of("0123456789", at + 1));
        const std::string_view digits = text.substr(at + 1, letter - at - 1);
        const bool is_number = letter < text.size() && std::string_view("diu").find(text[letter]) != std::string::npos;
        const int64_t width = digits.empty() ? 0 : whole_of(digits).value_or(WIDEST + 1);
        if (has_number || !is_number || width > int64_t(WIDEST)) {
            fields.refuse(field, "a pattern with one number, as in slice%03d.raw 1 93 1");
        }
        has_number = true;
        pattern.width = size_t(width);
        pattern.has_zeros = digits.starts_with('0');
        at = letter;
    }
    return pattern;
}

fs::path path_of(const HeaderFields& fields, const char* field, const std::string& name)
{
    if (has_controls(name)) fields.refuse(field, "names of files");
    return file_stated(fields.path(), name);
}

/// Splits "a pattern with spaces%03d.raw 1 93 1 2" into words: the pattern, and up to four numbers after it.
std::vector<std::string_view> split_pattern(std::string_view text)
{
    std::vector<std::string_view> numbers;
    std::string_view rest = trimmed(text);
    while (numbers.size() < 4) {
        const size_t space = rest.find_last_of(" \t");
        if (space == std::string_view::npos || !whole_of(rest.substr(space + 1))) break;
        numbers.insert(numbers.begin(), rest.substr(space + 1));
        rest = trimmed(rest.substr(0, space));
    }
    numbers.insert(numbers.begin(), rest);
    return numbers;
}

std::vector<fs::path> files_of_pattern(const HeaderFields& fields, const char* field, std::string_view text)
{
    const std::vector<std::string_view> words = split_pattern(text);
    const Pattern pattern = parse_pattern(fields, field, words[0]);
    const int64_t first = *whole_of(words[1]);
    const int64_t last = *whole_of(words[2]);
    const int64_t step = *whole_of(words[3]);
    int64_t span = 0;
    const bool is_sound = first >= 0 && last >= 0 && step != 0 && step != INT64_MIN &&
                          !__builtin_sub_overflow(last, first, &span) && (span == 0 || (span > 0) == (step > 0)) &&
                          std::abs(span) / std::abs(step) < MAX_FILES;
    if (!is_sound) {
        fields.refuse(field,
                      sentence("a first and a last number from 0 and a step that leads from one to the other, to ",
                               "at most ", MAX_FILES, " files"));
    }
    std::vector<fs::path> files;
    for (int64_t i = 0; i <= span / step; ++i) {
        files.push_back(path_of(fields, field, pattern.name_of(first + i * step)));
    }
    return files;
}

std::vector<fs::path> files_of_list(const HeaderFields& fields, const char* field, std::string_view rest)
{
    std::vector<fs::path> files;
    while (!rest.empty()) {
        const std::string_view line = trimmed(take_line(rest));
        if (!line.empty()) files.push_back(path_of(fields, field, std::string(line)));
        if (files.size() > MAX_FILES)
            fail(fields.path().string(), ": lists more than ", MAX_FILES, " files; expected fewer");
    }
    return files;
}

/// Returns how many axes each file covers, if the field's last word states this number ("2", or "2D" in MetaImage).
int64_t axes_of_a_file(const HeaderFields& fields, const char* field, const std::vector<std::string_view>& words,
                       size_t index)
{
    if (words.size() <= index) return 2;
    std::string_view word = words[index];
    if (word.ends_with('D') || word.ends_with('d')) word.remove_suffix(1);
    const int64_t axes = whole_of(word).value_or(0);
    if (axes < 1 || axes > 3) fields.refuse(field, "1, 2 or 3 as the number of axes that each file has");
    return axes;
}

int64_t choose(const std::string& file, const std::string& choice, int64_t count, std::span<const char* const> names,
               const char* what, const char* option)
{
    for (size_t i = 0; i < names.size(); ++i) {
        if (lower_case(choice) == lower_case(names[i])) return int64_t(i);
    }
    if (choice.empty() && count == 1) return 0;
    const std::optional<int64_t> number = whole_of(choice);
    if (number && *number >= 1 && *number <= count) return *number - 1;
    std::string choices = sentence("1 to ", count);
    for (const char* name : names) choices += sentence(", ", name);
    if (choice.empty())
        throw ChoiceNeeded(
            sentence(file, ": holds ", count, " ", what, "; expected ", option, " to choose one: ", choices),
            {Choice::numbered(option, count, {names.begin(), names.end()})});
    fail(file, ": ", option, " is ", in_quotes(choice), "; expected ", choices);
}

}  // namespace

bool is_list(std::string_view data_file)
{
    const std::vector<std::string_view> words = words_of(data_file);
    return !words.empty() && words[0] == "LIST" && words.size() <= 2;
}

bool is_pattern(std::string_view data_file)
{
    return data_file.find('%') != std::string_view::npos && split_pattern(data_file).size() >= 4;
}

std::vector<fs::path> data_files(const HeaderFields& fields, const char* field, std::string_view rest,
                                 const Size3& size)
{
    const std::string& value = fields.required(field, "the names of files");
    const bool from_list = is_list(value);
    const int64_t axes = from_list ? axes_of_a_file(fields, field, words_of(value), 1)
                                   : axes_of_a_file(fields, field, split_pattern(value), 4);
    std::vector<fs::path> files =
        from_list ? files_of_list(fields, field, rest) : files_of_pattern(fields, field, value);
    const auto count = int64_t(files.size());
    const int64_t rows = size.y * size.z;
    const bool fits = count > 0 && (axes == 3 ? size.z % count == 0 : count == (axes == 2 ? size.z : rows));
    if (!fits) {
        fail(fields.path().string(), ": ", field, " names ", count, " files; expected ",
             axes == 3 ? sentence("a number that divides the ", size.z, " slices")
                       : sentence(axes == 2 ? size.z : rows, ", one for each ", axes == 2 ? "slice" : "row"));
    }
    return files;
}

int64_t chosen_channel(const std::string& file, const OpenOptions& options, int64_t count,
                       std::span<const char* const> names)
{
    return choose(file, options.channel, count, names, "channels", "channel");
}

int64_t chosen_frame(const std::string& file, const OpenOptions& options, int64_t count)
{
    return choose(file, options.frame, count, {}, "time points", "frame");
}

std::span<const char* const> color_names(int64_t count)
{
    static constexpr const char* NAMES[] = {"red", "green", "blue", "alpha"};
    if (count != 3 && count != 4) return {};
    return std::span(NAMES).first(size_t(count));
}

}  // namespace shvr
