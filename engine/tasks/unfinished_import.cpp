#include "engine/tasks/unfinished_import.h"

#include "engine/base/error.h"
#include "engine/projects/part_folder.h"

namespace shvr {

namespace fs = std::filesystem;

namespace {

fs::path part_of(const fs::path& project)
{
    return plain_path(project).string() + ".part";
}

double bytes_in(const fs::path& folder)
{
    double bytes = 0.0;
    std::error_code error;
    for (fs::recursive_directory_iterator entry(folder, error); !error && entry != fs::recursive_directory_iterator();
         entry.increment(error)) {
        std::error_code none;
        if (entry->is_regular_file(none) && !none) bytes += double(entry->file_size(none));
    }
    return bytes;
}

}  // namespace

std::optional<UnfinishedImport> unfinished_import(const fs::path& project)
{
    if (project.empty()) return std::nullopt;
    const fs::path part = part_of(project);
    std::error_code ignored;
    if (!fs::is_directory(part, ignored)) return std::nullopt;
    try {
        const PartFolder held(project, true);  // fails while a process works on it
        return UnfinishedImport{part, bytes_in(part)};
    } catch (const Error&) {
        return std::nullopt;
    }
}

void delete_unfinished_import(const fs::path& project)
{
    const fs::path part = part_of(project);
    std::error_code ignored;
    if (!fs::is_directory(part, ignored)) return;
    PartFolder folder(project, true);
    folder.abandon();
    if (fs::exists(part, ignored))
        fail(part.string(), ": could not be deleted; expected the right to delete all files in it");
}

}  // namespace shvr
