#include "engine/projects/part_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <utility>

#include "engine/base/error.h"
#include "engine/base/machine/folder_lock.h"
#include "engine/projects/foreign_content.h"

namespace shvr {
namespace {

namespace fs = std::filesystem;

fs::path with_suffix(const fs::path& path, const char* suffix)
{
    fs::path result = path;
    return result += suffix;
}

bool is_there(const fs::path& path)
{
    std::error_code ignored;
    return fs::symlink_status(path, ignored).type() != fs::file_type::not_found;
}

bool is_empty_folder(const fs::path& path)
{
    std::error_code ignored;
    return fs::is_directory(path, ignored) && !fs::is_symlink(path, ignored) && fs::is_empty(path, ignored);
}

[[noreturn]] void refuse_write(const fs::path& path, int error_number)
{
    fail(path.string(), ": cannot be written: ", reason_of(error_number));
}

void make_folder(const fs::path& path)
{
    if (::mkdir(path.c_str(), 0777) != 0 && errno != EEXIST) refuse_write(path, errno);
}

FileDescriptor locked(const fs::path& folder)
{
    std::optional<FileDescriptor> lock = lock_folder(folder, WithoutLocks::allowed);
    if (lock) return std::move(*lock);
    if (errno != EWOULDBLOCK) fail(folder.string(), ": cannot be opened: ", reason_of(errno));
    fail(folder.string(),
         ": another process is importing into it; expected no other: wait until it ends, or choose another name");
}

constexpr const char* METADATA[] = {".zattrs", ".zgroup", ".zarray", "zarr.json", ".zmetadata"};

bool is_zarr(const fs::path& folder)
{
    return std::ranges::any_of(METADATA, [&](const char* name) { return is_there(folder / name); });
}

/// Whether SHVR or Zarr may put an entry with this name into a project: metadata, arrays, groups, chunks, or shvr.
bool belongs_to_zarr(const fs::path& path)
{
    const std::string name = path.filename().string();
    const bool is_chunk = name == "c" || name.find_first_not_of("0123456789.") == std::string::npos;
    return std::ranges::find(METADATA, name) != std::end(METADATA) || is_chunk || name == "shvr" || name == "labels" ||
           name == "OME" || is_zarr(path);
}

/// Whether the file is a temporary one, left by a process that died while writing (engine/base/atomic_writer.h).
bool is_temporary(const fs::path& path)
{
    return path.filename().string().starts_with(".shvr-");
}

/// Returns entries that belong neither to a project or another Zarr folder nor to a file browser, so that the folder
/// must not be deleted. At most MAX_FOREIGN_NAMES.
std::vector<std::string> entries_foreign_to_zarr(const fs::path& folder)
{
    std::vector<std::string> names;
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
        if (belongs_to_zarr(entry.path()) || is_temporary(entry.path()) || is_desktop_file(entry.path())) continue;
        names.push_back(entry.path().filename().string());
        if (names.size() == MAX_FOREIGN_NAMES) break;
    }
    std::ranges::sort(names);
    return names;
}

/// Removes everything in the folder.
void remove_content(const fs::path& folder)
{
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        if (entry.path().filename() == FOLDER_LOCK) continue;
        fs::remove_all(entry.path(), error);
        if (error) fail(entry.path().string(), ": cannot be removed: ", error.message());
    }
}

}  // namespace

PartFolder::PartFolder(const fs::path& target, bool overwrites)
    : target_(plain_path(target)), part_(with_suffix(target_, ".part")), overwrites_(overwrites)
{
    check_target(target_, overwrites_);
    if (!is_there(part_)) make_folder(part_);
    lock_.emplace(locked(part_));
    // A folder that has this name by chance must stay. A folder left by an import has a state, or only the folder shvr.
    if (is_there(state())) return;
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(part_, error)) {
        if (entry.path().filename() == "shvr" || entry.path().filename() == FOLDER_LOCK) continue;
        fail(part_.string(),
             ": is not the remainder of an import; expected no such folder: move it, or choose another name");
    }
    make_folder(part_ / "shvr");
}

fs::path PartFolder::state() const
{
    return part_ / "shvr" / "import.state";
}

bool is_target_taken(const fs::path& target)
{
    return is_there(plain_path(target)) && !is_empty_folder(plain_path(target));
}

FoundTarget found_at(const fs::path& target)
{
    if (!is_target_taken(target)) return {};
    if (!is_zarr(target)) return {.is_taken = true};
    return {.is_taken = true, .is_project = true, .foreign = entries_foreign_to_zarr(target)};
}

void check_target(const fs::path& target, bool overwrites)
{
    const FoundTarget found = found_at(target);
    if (!found.is_taken) return;
    if (!overwrites) fail(target.string(), ": already exists; expected a new name, or --overwrite");
    if (!found.is_project)
        fail(target.string(),
             ": is not a project; expected one, since --overwrite replaces nothing else: choose a new name");
    if (!found.foreign.empty())
        fail(target.string(), ": holds ", in_words(found.foreign),
             ", no part of a project; expected nothing else there, since --overwrite removes the whole folder: move "
             "that, "
             "or choose a new name");
}

void PartFolder::clear() const
{
    remove_content(part_);
    make_folder(part_ / "shvr");
}

void PartFolder::clear_temporary() const
{
    std::error_code error;
    for (const fs::path& folder : {part_, part_ / "shvr"})
        for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
            if (is_temporary(entry.path()) && entry.path().filename() != FOLDER_LOCK) fs::remove(entry.path(), error);
}

void PartFolder::sync() const
{
    if (::syncfs(lock_->number()) != 0) refuse_write(part_, errno);
}

void PartFolder::finish()
{
    sync();
    check_target(target_, overwrites_);  // checks again, since the target may have appeared meanwhile
    if (is_target_taken(target_)) {
        // Exchanges the two names atomically, so that either the old or the new project is in place at every moment.
        if (::renameat2(AT_FDCWD, part_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) != 0) {
            refuse_write(target_, errno);
        }
        std::error_code error;
        fs::remove_all(part_, error);
        if (error) fail(part_.string(), ": is the project that was replaced, and cannot be deleted: ", error.message());
    } else if (::rename(part_.c_str(), target_.c_str()) != 0) {
        refuse_write(target_, errno);
    }
    part_ = target_;
    lock_.reset();            // NFS cannot remove a file that is open
    std::error_code ignored;  // a remaining state does no harm
    fs::remove(target_ / FOLDER_LOCK, ignored);
    fs::remove(state(), ignored);
    fs::remove(state().parent_path(), ignored);  // removes it only if it is empty
    const FileDescriptor parent(::open(target_.parent_path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    // Ignores EINVAL (file system cannot sync folders) and EACCES (folder is writable but not readable).
    if (parent && ::fsync(parent.number()) != 0 && errno != EINVAL && errno != EACCES) {
        fail(target_.string(),
             ": is written, but a power cut could lose it; its folder cannot be synced: ", reason_of(errno));
    }
}

void PartFolder::abandon()
{
    if (part_ != target_) remove_locked_folder(part_, lock_);
}

fs::path plain_path(const fs::path& path)
{
    const fs::path whole = fs::absolute(path).lexically_normal();
    return whole.has_filename() ? whole : whole.parent_path();
}

void write_part_file(const fs::path& path, std::span<const std::byte> content)
{
    constexpr int FLAGS = O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC;
    int number = ::open(path.c_str(), FLAGS, 0666);
    if (number < 0 && errno == ENOENT) {
        std::error_code error;
        fs::create_directories(path.parent_path(), error);
        if (error) fail(path.parent_path().string(), ": cannot be created: ", error.message());
        number = ::open(path.c_str(), FLAGS, 0666);
    }
    const FileDescriptor file(number);
    if (!file) refuse_write(path, errno);
    while (!content.empty()) {
        const ssize_t count = ::write(file.number(), content.data(), content.size());
        if (count < 0 && errno == EINTR) continue;
        // Writing nothing without an error means a full disk on some network file systems.
        if (count <= 0) refuse_write(path, count < 0 ? errno : ENOSPC);
        content = content.subspan(size_t(count));
    }
    // Starts writing to the disk early, which shortens the final sync. A failure here does no harm.
    static_cast<void>(::sync_file_range(file.number(), 0, 0, SYNC_FILE_RANGE_WRITE));
}

}  // namespace shvr
