#include "engine/tasks/task_output.h"

#include <linux/magic.h>
#include <sys/statfs.h>
#include <unistd.h>

#include <algorithm>
#include <climits>
#include <string_view>

#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/text.h"
#include "engine/remote/address.h"
#include "engine/session/session.h"

namespace shvr {

namespace fs = std::filesystem;

namespace {

/// Returns the extension of a file that may be a slice, with one spelling per format. Returns an empty text otherwise.
std::string slice_extension(const fs::path& path)
{
    const std::string extension = lower_case(path.extension().string());
    if (extension == ".tiff") return ".tif";
    if (extension == ".jpeg") return ".jpg";
    constexpr std::string_view SLICES[] = {".tif", ".png", ".bmp", ".jpg", ".dcm"};
    return std::ranges::find(SLICES, extension) != std::end(SLICES) ? extension : std::string();
}

/// Whether `output` would become a slice of a volume: it lies directly in `folder` and has the extension of the slices
/// there. Folders of Zarr images are exempt, since such an image may contain other images.
bool is_among_slices(const fs::path& folder, const fs::path& output)
{
    std::error_code ignored;
    const std::string extension = slice_extension(output);
    if (extension.empty() || !fs::is_directory(folder, ignored)) return false;
    for (const char* name : {".zattrs", ".zgroup", ".zarray", "zarr.json"})
        if (fs::exists(folder / name, ignored)) return false;
    if (!fs::equivalent(fs::absolute(output).parent_path(), folder, ignored)) return false;
    for (fs::directory_iterator entry(folder, ignored); !ignored && entry != fs::directory_iterator();
         entry.increment(ignored))
        if (slice_extension(entry->path()) == extension) return true;
    return false;
}

/// Whether the kernel makes what is in the folder. To an administrator such folders look writable.
bool is_of_kernel(const fs::path& folder)
{
    struct statfs status {};
    return ::statfs(folder.c_str(), &status) == 0 &&
           (status.f_type == PROC_SUPER_MAGIC || status.f_type == SYSFS_MAGIC);
}

void expect_writable(const std::string& name, const fs::path& folder)
{
    if (::access(folder.c_str(), W_OK | X_OK) != 0 || is_of_kernel(folder))
        fail(name, ": cannot be written: the folder ", folder.string(), " may not be written to");
}

/// Says what is there instead of the folder.
std::string why_no_folder(const fs::path& folder)
{
    std::error_code ignored;
    return fs::exists(folder, ignored) ? folder.string() + " is a file; expected a folder"
                                       : "there is no folder " + folder.string();
}

/// Bytes by which the name of an unfinished folder is longer than its own: ".NAME.shvr-part".
constexpr size_t MAX_ADDED_BYTES = 16;

/// Fails if the folder, which exists, cannot have an entry of this name. `added`: bytes that the name may grow by.
void expect_short_name(const fs::path& name, const fs::path& folder, size_t added)
{
    const long limit = ::pathconf(folder.c_str(), _PC_NAME_MAX);
    const size_t most = (limit > 0 ? size_t(limit) : size_t(NAME_MAX)) - added;
    const size_t bytes = name.string().size();
    if (bytes > most)
        fail("the name ", in_quotes(name.string()), " is too long, with ", bytes, " bytes; expected at most ", most);
}

/// Fails if nothing can be made at the path. `added`: as above.
void expect_place(const fs::path& path, size_t added)
{
    const std::string name = path.string();
    const fs::path folder = fs::absolute(path).parent_path();
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) fail(name, ": cannot be written: ", why_no_folder(folder));
    expect_short_name(path.filename(), folder, added);
    expect_writable(name, folder);
}

void expect_local(const fs::path& path)
{
    if (leads_to_network(path))
        fail(path.string(),
             ": cannot be written: nothing is written over a network; expected a folder on this machine");
}

fs::path without_slash(const fs::path& path)
{
    const fs::path whole = fs::absolute(path).lexically_normal();
    return whole.has_filename() ? whole : whole.parent_path();
}

/// Returns the folder, or the nearest one around it, that exists.
fs::path existing_part(fs::path folder)
{
    std::error_code ignored;
    while (!fs::exists(folder, ignored) && folder.has_relative_path()) folder = folder.parent_path();
    return folder;
}

}  // namespace

void check_output(const std::string& option, const std::filesystem::path& path,
                  const std::vector<std::string>& extensions)
{
    if (path.empty()) return;
    const std::string extension = lower_case(path.extension().string()), name = path.string();
    if (std::ranges::find(extensions, extension) == extensions.end()) {
        std::string all;
        for (const std::string& known : extensions) all += (all.empty() ? "" : ", ") + known;
        throw UsageError(sentence(option, " is '", name, "'; expected a name that ends in one of: ", all));
    }
    check_output_place(path);
}

void check_output_place(const std::filesystem::path& path)
{
    expect_place(path, 0);
    std::error_code ignored;
    if (fs::is_directory(path, ignored)) fail(path.string(), ": is a folder; expected the name of a file");
}

fs::path written_path(const fs::path& path)
{
    std::error_code ignored;
    fs::path target = fs::is_symlink(path, ignored) && !fs::is_directory(path, ignored) ? link_target(path) : path;
    collect_temporary_files(target.parent_path());
    return target;
}

fs::path file_of_input(const fs::path& input)
{
    std::error_code ignored;
    const fs::path session = fs::is_directory(input, ignored) ? session_file_of(input) : fs::path();
    return session.empty() ? input : session;
}

void check_output_is_not(const fs::path& input, const fs::path& output)
{
    if (input.empty() || output.empty()) return;
    std::error_code ignored;
    if (fs::exists(output, ignored) && fs::equivalent(output, input, ignored))
        fail(output.string(), ": is read; expected another name, since it would be lost");
    if (!is_among_slices(input, output)) return;
    if (fs::exists(output, ignored))
        fail(output.string(), ": is read, as a part of ", input.string(),
             "; expected another name, since it would be lost");
    fail(output.string(), ": would be read as a slice of ", input.string(), "; expected a name in another folder");
}

void check_output_folder(const std::filesystem::path& path)
{
    expect_local(path);
    const fs::path whole = without_slash(path), folder = existing_part(whole);
    std::error_code ignored;
    if (!fs::is_directory(folder, ignored)) fail(path.string(), ": cannot be written: ", why_no_folder(folder));
    for (const fs::path& name : whole.lexically_relative(folder)) expect_short_name(name, folder, MAX_ADDED_BYTES);
    expect_writable(path.string(), folder);
}

void check_new_folder(const fs::path& path)
{
    expect_local(path);
    expect_place(without_slash(path), MAX_ADDED_BYTES);
}

std::optional<double> free_space(const fs::path& path)
{
    std::error_code error;
    const fs::path whole = fs::absolute(path, error);
    if (error) return std::nullopt;
    const fs::space_info space = fs::space(existing_part(whole), error);
    return error || space.capacity == 0 ? std::nullopt : std::optional(double(space.available));
}

}  // namespace shvr
