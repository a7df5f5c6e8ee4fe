#include "ui/files/annotation_beside.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "engine/base/text.h"
#include "ui/files/file_list.h"

namespace shvr::ui {

namespace fs = std::filesystem;

namespace {

/// Endings that only annotation has, and words in names of files with any other ending.
constexpr std::array<std::string_view, 6> ENDINGS{".mask", ".offset", ".swc", ".graphml", ".rsml", ".seg.nrrd"};
constexpr std::array<std::string_view, 5> WORDS{"mask", "label", "segmentation", "trace", "offset"};
constexpr std::array<std::string_view, 11> IMAGES{".nrrd", ".nhdr", ".tif",    ".tiff", ".zarr", ".mha",
                                                  ".mhd",  ".nii",  ".nii.gz", ".hdr",  ".txt"};

bool looks_like_annotation(const std::string& name)
{
    const std::string lower = lower_case(name);
    const auto ends = [&](std::string_view ending) { return lower.ends_with(ending); };
    const auto holds = [&](std::string_view word) { return lower.find(word) != std::string::npos; };
    return std::ranges::any_of(ENDINGS, ends) ||
           (std::ranges::any_of(IMAGES, ends) && std::ranges::any_of(WORDS, holds));
}

/// "leaf-mask.nrrd" and "leaf.session.labels.zarr" begin with "leaf"; "leaflet-mask.nrrd" does not.
bool begins_with_any(const std::string& name, const std::vector<std::string>& stems)
{
    return std::ranges::any_of(stems, [&](const std::string& stem) {
        return !stem.empty() && name.starts_with(stem) && name.size() > stem.size() &&
               !std::isalnum(static_cast<unsigned char>(name[stem.size()]));
    });
}

}  // namespace

std::vector<FoundFile> annotation_beside(const fs::path& folder, const std::vector<fs::path>& own,
                                         const std::vector<std::string>& stems)
{
    constexpr size_t MAX_EXAMINED = 10000;
    struct Dated {
        FoundFile file;
        bool is_of_scan;
        fs::file_time_type changed;
    };
    std::vector<Dated> found;
    std::error_code error;
    size_t looked_at = 0;
    for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
        if (++looked_at > MAX_EXAMINED) break;
        const std::string name = at->path().filename().string();
        if (!looks_like_annotation(name) || std::ranges::find(own, at->path()) != own.end()) continue;
        std::error_code unknown;
        const bool is_file = at->is_regular_file(unknown);
        if (what_is_at(at->path()) != There::file) continue;
        const uintmax_t bytes = is_file ? at->file_size(unknown) : 0;
        found.push_back({{at->path(), name, is_file && !unknown ? size_text(int64_t(bytes)) : ""},
                         begins_with_any(name, stems),
                         at->last_write_time(unknown)});
    }
    std::ranges::sort(found, [](const Dated& a, const Dated& b) {
        if (a.is_of_scan != b.is_of_scan) return a.is_of_scan;
        return a.changed != b.changed ? a.changed > b.changed : a.file.name < b.file.name;
    });
    std::vector<FoundFile> files;
    for (Dated& each : found) files.push_back(std::move(each.file));
    return files;
}

There what_is_at(const fs::path& path)
{
    std::error_code ignored;
    if (!fs::is_directory(path, ignored)) return fs::exists(path, ignored) ? There::file : There::nothing;
    const bool is_image = std::ranges::any_of(std::array{".zattrs", ".zarray", "zarr.json"},
                                              [&](const char* name) { return fs::exists(path / name, ignored); });
    return is_image ? There::file : There::folder;
}

}  // namespace shvr::ui
