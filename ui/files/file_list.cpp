#include "ui/files/file_list.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <iterator>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/open_volume.h"
#include "engine/remote/address.h"
#include "ui/files/asked.h"

namespace shvr::ui {

namespace fs = std::filesystem;

namespace {

/// Maximum number of names that are examined to complete a path.
constexpr size_t MAX_COMPLETED = 200'000;

char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
}

bool begins_with(std::string_view name, std::string_view text)
{
    return name.size() >= text.size() && std::ranges::equal(name.substr(0, text.size()), text, {}, lower, lower);
}

/// Returns the digits that begin at `at`, without leading zeros.
std::string_view number_at(std::string_view text, size_t at)
{
    size_t end = at;
    while (end < text.size() && is_digit(text[end])) ++end;
    while (at + 1 < end && text[at] == '0') ++at;
    return text.substr(at, end - at);
}

}  // namespace

bool is_naturally_before(std::string_view a, std::string_view b)
{
    size_t i = 0, j = 0;
    while (i < a.size() && j < b.size()) {
        if (is_digit(a[i]) && is_digit(b[j])) {
            const std::string_view one = number_at(a, i), other = number_at(b, j);
            if (one.size() != other.size()) return one.size() < other.size();
            if (one != other) return one < other;
            i = size_t(one.data() - a.data()) + one.size();
            j = size_t(other.data() - b.data()) + other.size();
        } else if (lower(a[i]) != lower(b[j])) {
            return uint8_t(lower(a[i])) < uint8_t(lower(b[j]));
        } else {
            ++i, ++j;
        }
    }
    if (i < a.size() || j < b.size()) return j < b.size();
    return a < b;
}

// ---- A folder -------------------------------------------------------------------------------------------------------

void FileList::enter(const fs::path& folder, size_t at_once)
{
    folder_ = folder;
    entries_.clear();
    rows_.clear();
    details_.clear();
    failure_.clear();
    unanswered_ = 0;
    is_reading_ = true;
    reader_ = std::make_unique<FolderReader>(folder, at_once);
    reader_->wait(AT_ONCE);
    read_on();
}

bool FileList::read_on()
{
    if (!reader_) return false;
    const size_t first = entries_.size();
    FolderReader::News news = reader_->take();
    entries_.insert(entries_.end(), std::make_move_iterator(news.entries.begin()),
                    std::make_move_iterator(news.entries.end()));
    for (auto& [name, details] : news.details) details_[name] = std::move(details);
    unanswered_ -= news.details.size();
    failure_ = std::move(news.failure);
    is_reading_ = news.is_reading;
    take(first);
    return is_reading_;
}

void FileList::show(bool all_files, bool hidden)
{
    if (all_files == shows_all_files_ && hidden == shows_hidden_) return;
    shows_all_files_ = all_files;
    shows_hidden_ = hidden;
    rows_.clear();
    take(0);
}

bool FileList::is_shown(const Entry& entry) const
{
    if (!shows_hidden_ && entry.name.starts_with('.')) return false;
    if (entry.is_folder || shows_all_files_) return true;
    const std::string name = lower_case(entry.name);
    // A mask's .mask.json gets no row, since it is opened together with the mask. DICOM files often have no suffix.
    return is_volume_name(entry.name) || (name.ends_with(".json") && !name.ends_with(".mask.json")) ||
           fs::path(entry.name).extension().empty();
}

bool FileList::is_before(uint32_t a, uint32_t b) const
{
    const Entry &one = entries_[a], &other = entries_[b];
    return one.is_folder != other.is_folder ? one.is_folder : is_naturally_before(one.name, other.name);
}

void FileList::take(size_t first_new)
{
    const auto before = [this](uint32_t a, uint32_t b) { return is_before(a, b); };
    const auto had = std::ptrdiff_t(rows_.size());
    for (size_t i = first_new; i < entries_.size(); ++i)
        if (is_shown(entries_[i])) rows_.push_back(uint32_t(i));
    std::sort(rows_.begin() + had, rows_.end(), before);
    std::inplace_merge(rows_.begin(), rows_.begin() + had, rows_.end(), before);
}

const FileDetails& FileList::details(size_t row)
{
    const auto [found, is_new] = details_.try_emplace(at(row).name);
    if (is_new) {
        reader_->ask_about(at(row).name);
        ++unanswered_;
    }
    return found->second;
}

std::optional<size_t> FileList::row_of(std::string_view name) const
{
    for (size_t row = 0; row < size(); ++row)
        if (at(row).name == name) return row;
    return std::nullopt;
}

std::optional<size_t> FileList::row_beginning(std::string_view text, size_t from) const
{
    for (size_t i = 0; i < size(); ++i) {
        const size_t row = (from + i) % size();
        if (begins_with(at(row).name, text)) return row;
    }
    return std::nullopt;
}

std::string size_text(int64_t bytes)
{
    constexpr const char* UNITS[] = {"B", "kB", "MB", "GB", "TB", "PB"};
    double value = double(bytes);
    size_t unit = 0;
    while (value >= 999.5 && unit + 1 < std::size(UNITS)) value /= 1000.0, ++unit;
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), unit == 0 || value >= 99.95 ? "%.0f %s" : "%.1f %s", value, UNITS[unit]);
    return text.data();
}

// ---- Typed paths ----------------------------------------------------------------------------------------------------

fs::path home_folder()
{
    const char* const home = std::getenv("HOME");
    return home && *home == '/' ? fs::path(home) : fs::path("/");
}

fs::path typed_path(std::string_view typed, const fs::path& folder)
{
    typed = trimmed(typed);
    if (typed.size() >= 2 && (typed.front() == '"' || typed.front() == '\'') && typed.back() == typed.front())
        typed = typed.substr(1, typed.size() - 2);
    if (typed.starts_with("file:///")) typed.remove_prefix(7);
    fs::path path(typed);
    if (typed == "~" || typed.starts_with("~/")) path = home_folder() / typed.substr(std::min<size_t>(2, typed.size()));
    path = (folder / path).lexically_normal();
    // Removes a slash at the end, which would make the path's last component an empty name.
    return path.has_filename() || path == path.root_path() ? path : path.parent_path();
}

bool is_typed_address(std::string_view typed)
{
    return is_address(trimmed(typed));
}

std::string without_query(const std::string& typed)
{
    try {
        return take_query(typed);
    } catch (const Error&) {
        return url_without_query(typed);
    }
}

std::string typed_address(std::string_view typed)
{
    std::string address = take_query(std::string(trimmed(typed)));
    static_cast<void>(parse_address(address));
    return address;
}

std::string completed(const std::string& typed, const fs::path& folder)
{
    const size_t slash = typed.rfind('/');
    const std::string before = slash == std::string::npos ? "" : typed.substr(0, slash + 1);
    const std::string begun = typed.substr(before.size());
    if (begun == "~" || begun == "..") return typed + "/";
    std::string common;
    size_t matches = 0, looked_at = 0;
    bool is_folder = false;
    std::error_code error, ignored;
    for (fs::directory_iterator each(typed_path(before, folder), error);
         !error && each != fs::directory_iterator() && ++looked_at <= MAX_COMPLETED; each.increment(error)) {
        const std::string name = each->path().filename().string();
        if (!name.starts_with(begun) || (begun.empty() && name.starts_with('.'))) continue;
        if (matches++ == 0) {
            common = name;
            is_folder = each->is_directory(ignored);
        } else {
            common.resize(size_t(std::ranges::mismatch(common, name).in1 - common.begin()));
        }
    }
    if (matches == 0) return typed;
    return before + common + (matches == 1 && is_folder ? "/" : "");
}

Verdict verdict_on(const fs::path& path, Wanted wanted, bool enters_folders)
{
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    const bool is_folder = fs::is_directory(status);
    if (wanted == Wanted::scan) {
        // A path within an archive is no entry of the file system, so its absence there is no error.
        if (!fs::exists(status) && !is_within_archive(path)) {
            const bool is_gone = !error || error == std::errc::no_such_file_or_directory;
            return {false,
                    sentence(path.string(), ": ", is_gone ? "there is no such file or folder" : error.message())};
        }
        return {is_folder && !is_opened_whole(details_of(path).kind), {}};
    }
    if (is_folder && (enters_folders || wanted != Wanted::any)) return {true, {}};
    if (wanted == Wanted::file)
        return {false, fs::exists(status) ? "" : sentence(path.string(), ": there is no such file")};
    if (wanted == Wanted::new_file && fs::exists(status))
        return {false, sentence(path.string(), ": is there already; type another name")};
    if (!fs::is_directory(path.parent_path(), error))
        return {false, sentence(path.parent_path().string(), ": is no folder; choose one for the file")};
    return {};
}

std::string names_of_formats(std::string_view conjunction)
{
    return format_names(conjunction);
}

bool is_within_archive(const fs::path& path)
{
    return leads_into_archive(path);
}

std::vector<Place> places(const fs::path& open, const std::vector<fs::path>& recent)
{
    constexpr size_t MAX_PLACES = 12;
    std::vector<Place> found{{"Home", home_folder()}};
    const auto add = [&](const fs::path& folder) {
        if (folder.empty() || found.size() == MAX_PLACES) return;
        if (std::ranges::find(found, folder, &Place::folder) != found.end()) return;
        const std::string name = folder.filename().string();
        found.push_back({name.empty() ? folder.string() : name, folder});
    };
    // A project's files lie in a subfolder: the project's folder, as the user knows it, is the parent.
    const bool is_here = !open.empty() && !is_address(open.string());
    const fs::path whole = is_here ? fs::absolute(open).lexically_normal() : fs::path();
    if (whole.parent_path().filename() == "shvr")
        add(whole.parent_path().parent_path().parent_path());
    else
        add(whole.parent_path());
    for (const fs::path& path : recent)
        if (!is_address(path.string())) add(path.parent_path());
    return found;
}

}  // namespace shvr::ui
