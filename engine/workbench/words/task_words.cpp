#include "engine/workbench/words/task_words.h"

#include <filesystem>

#include "engine/base/text.h"
#include "engine/session/words/number_words.h"
#include "engine/workbench/forms/form_names.h"

namespace shvr::ui {

namespace fs = std::filesystem;

namespace {

/// "a", "a and b", "a, b and c"
std::string listed(const std::vector<std::string>& items)
{
    std::string list;
    for (size_t i = 0; i < items.size(); ++i) list += (i == 0 ? "" : i + 1 < items.size() ? ", " : " and ") + items[i];
    return list;
}

fs::path folder_of(const std::string& path)
{
    const fs::path file = fs::path(path).lexically_normal();
    return (file.has_filename() ? file : file.parent_path()).parent_path();
}

}  // namespace

std::string exported_in_words(std::span<const std::string> written, double bytes)
{
    std::vector<std::string> names, paths;
    bool is_one_folder = true;
    for (const std::string& path : written) {
        paths.push_back(path);
        names.push_back(fs::path(path).filename().string());
        is_one_folder = is_one_folder && folder_of(path) == folder_of(written.front());
    }
    const std::string size = bytes > 0.0 ? sentence(" (", bytes_in_words(bytes), ")") : "";
    if (written.empty() || !is_one_folder) return sentence("Exported ", listed(paths), size);
    return sentence("Exported ", listed(names), " to ", folder_of(written.front()).string(), size);
}

double bytes_of_files(std::span<const std::string> paths)
{
    double bytes = 0.0;
    std::error_code error;
    for (const std::string& path : paths) {
        if (!fs::is_directory(path, error)) {
            const uintmax_t size = fs::file_size(path, error);
            bytes += error ? 0.0 : double(size);
            continue;
        }
        for (fs::recursive_directory_iterator at(path, error), end; !error && at != end; at.increment(error))
            if (std::error_code unknown; at->is_regular_file(unknown)) bytes += double(at->file_size(unknown));
    }
    return bytes;
}

std::string labelled_in_words(const Components::Counts& counts, const LabelTask& task)
{
    return sentence(
        "Found ", shvr::counted(counts.found, "connected part"), " at or above ", number_in_words(task.threshold),
        counts.found > 0 ? sentence(", the largest of ", shvr::counted(counts.largest_voxels, "voxel")) : "",
        task.output.empty() ? "" : "; the labels are in " + task.output.string());
}

std::string compared_in_words(const EvaluateResult& result)
{
    std::vector<std::string> parts;
    if (result.dice && result.dice->painted) parts.push_back("Dice " + number_in_words(*result.dice->painted));
    if (result.nodes && result.nodes->mean)
        parts.push_back(sentence("nodes ", number_in_words(*result.nodes->mean), " inside the mask"));
    if (result.internodes && result.internodes->mean)
        parts.push_back("internodes " + number_in_words(*result.internodes->mean));
    if (result.traces)
        parts.push_back(sentence(result.traces->segments_found, " of ", result.traces->segments_total,
                                 " segments found, ",
                                 shvr::counted(result.traces->topological_errors(), "topological error")));
    if (parts.empty()) return "There was nothing to compare";
    std::string text = "Compared with the reference: ";
    for (size_t i = 0; i < parts.size(); ++i) text += (i == 0 ? "" : ", ") + parts[i];
    return text;
}

}  // namespace shvr::ui
