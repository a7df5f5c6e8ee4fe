#include "ui/files/file_list.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>

#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/formats/open_volume.h"

namespace shvr::ui {

namespace fs = std::filesystem;

namespace {

/// Names that are looked at to tell what a folder holds.
constexpr int SAMPLED_NAMES = 64;
/// A completion of a path looks at no more names than that.
constexpr size_t MAX_COMPLETED = 200'000;

constexpr const char* ANNOTATION_ENDINGS[] = {".mask", ".offsets", ".graphml", ".swc", ".journal"};

char lower(char c)
{
    return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
}

bool begins_with(std::string_view name, std::string_view text)
{
    return name.size() >= text.size() && std::ranges::equal(name.substr(0, text.size()), text, {}, lower, lower);
}

/// The digits at `at`, without zeros before them.
std::string_view number_at(std::string_view text, size_t at)
{
    size_t end = at;
    while (end < text.size() && is_digit(text[end])) ++end;
    while (at + 1 < end && text[at] == '0') ++at;
    return text.substr(at, end - at);
}

std::string local_time(fs::file_time_type time)
{
    const std::time_t seconds = std::chrono::system_clock::to_time_t(
        std::chrono::time_point_cast<std::chrono::system_clock::duration>(std::chrono::file_clock::to_sys(time)));
    std::tm parts{};
    std::array<char, 32> text{};
    if (!localtime_r(&seconds, &parts)) return {};
    return {text.data(), std::strftime(text.data(), text.size(), "%Y-%m-%d %H:%M", &parts)};
}

FileKind kind_of_folder(const fs::path& folder)
{
    std::error_code ignored;
    if (fs::exists(folder / "shvr" / "session.json", ignored)) return FileKind::project;
    for (const char* name : {".zattrs", "zarr.json", ".zgroup", ".zarray"})
        if (fs::exists(folder / name, ignored)) return FileKind::zarr;
    int seen = 0, tiffs = 0, dicoms = 0;
    std::error_code error;
    for (fs::directory_iterator each(folder, error); !error && each != fs::directory_iterator();
         each.increment(error)) {
        const std::string name = lower_case(each->path().filename().string());
        tiffs += name.ends_with(".tif") || name.ends_with(".tiff");
        dicoms += name.ends_with(".dcm");
        if (++seen == SAMPLED_NAMES) break;
    }
    if (2 * dicoms > seen) return FileKind::dicom_series;
    return tiffs >= 2 && 2 * tiffs > seen ? FileKind::tiff_series : FileKind::folder;
}

const char* text_of(FileKind kind)
{
    switch (kind) {
        case FileKind::project: return "SHVR project";
        case FileKind::zarr: return "OME-Zarr volume";
        case FileKind::dicom_series: return "DICOM series";
        case FileKind::tiff_series: return "TIFF slices";
        case FileKind::folder: return "folder";
        case FileKind::volume: return "volume";
        case FileKind::session: return "SHVR session";
        case FileKind::annotation: return "annotation";
        case FileKind::other: break;
    }
    return "";
}

/// A session names itself at its beginning.
bool begins_as_session(const fs::path& path)
{
    std::array<char, 256> head{};
    std::ifstream file(path, std::ios::binary);
    file.read(head.data(), head.size());
    return std::string_view(head.data(), size_t(file.gcount())).find("\"shvr_session\"") != std::string_view::npos;
}

std::string reason(const std::error_code& error)
{
    return error == std::errc::permission_denied           ? "it may not be read"
           : error == std::errc::no_such_file_or_directory ? "it is not there"
           : error == std::errc::not_a_directory           ? "it is no folder"
                                                           : error.message();
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

void FileList::enter(const fs::path& folder)
{
    folder_ = folder;
    entries_.clear();
    rows_.clear();
    details_.clear();
    failure_.clear();
    std::error_code error;
    next_ = fs::directory_iterator(folder, error);
    is_reading_ = !error;
    if (error) failure_ = sentence(folder.string(), ": cannot be listed: ", reason(error));
}

bool FileList::read_on(size_t most)
{
    if (!is_reading_) return false;
    const size_t first = entries_.size();
    std::error_code error, ignored;
    for (; most > 0 && next_ != fs::directory_iterator(); --most) {
        // The kind comes with the name on most file systems, except behind a link.
        entries_.push_back({next_->path().filename().string(), next_->is_directory(ignored)});
        next_.increment(error);
        if (error) {
            failure_ = sentence(folder_.string(), ": only part of it can be listed: ", reason(error));
            next_ = {};
        }
    }
    is_reading_ = next_ != fs::directory_iterator();
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
    // What belongs to a mask is taken with it; DICOM files often have no ending.
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
    const auto [found, is_new] = details_.try_emplace(rows_[row]);
    if (is_new) found->second = details_of(folder_ / at(row).name);
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

FileDetails details_of(const fs::path& path)
{
    FileDetails details;
    std::error_code error;
    const fs::file_time_type changed = fs::last_write_time(path, error);
    if (!error) details.changed = local_time(changed);
    const std::string name = lower_case(path.filename().string());
    if (fs::is_directory(path, error)) {
        details.kind = kind_of_folder(path);
        details.kind_text = text_of(details.kind);
        return details;
    }
    if (const uintmax_t bytes = fs::file_size(path, error); !error) details.bytes = int64_t(bytes);
    const std::string_view format = format_of_name(name);
    if (name.ends_with(".json") && begins_as_session(path))
        details.kind = FileKind::session;
    else if (!format.empty())
        details.kind = FileKind::volume;
    else if (name.ends_with(".mask.json") ||
             std::ranges::any_of(ANNOTATION_ENDINGS, [&](const char* ending) { return name.ends_with(ending); }))
        details.kind = FileKind::annotation;
    details.kind_text = details.kind == FileKind::volume ? std::string(format) : text_of(details.kind);
    return details;
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
    // A slash at the end would make the last part of the path an empty name.
    return path.has_filename() || path == path.root_path() ? path : path.parent_path();
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
    // The files of a project lie in a folder of their own, within what a person would call the project.
    const fs::path whole = open.empty() ? open : fs::absolute(open).lexically_normal();
    if (whole.parent_path().filename() == "shvr")
        add(whole.parent_path().parent_path().parent_path());
    else
        add(whole.parent_path());
    for (const fs::path& path : recent) add(path.parent_path());
    return found;
}

}  // namespace shvr::ui
