#include "engine/projects/atomic_folder.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <utility>

#include "engine/base/atomic_file.h"
#include "engine/base/atomic_writer.h"
#include "engine/base/error.h"
#include "engine/base/machine/folder_lock.h"
#include "engine/projects/part_folder.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

/// Entry files are metadata.
constexpr int64_t MAX_ENTRY_BYTES = int64_t{16} << 20;

bool is_occupied(const fs::path& path)
{
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
}

[[noreturn]] void refuse_folder(const fs::path& target, int error_number)
{
    fail(target.string(), ": cannot be written: ", reason_of(error_number));
}

fs::path container_of(const fs::path& target)
{
    return target.parent_path() / sentence(".", target.filename().string(), ".shvr-part");
}

void make_folder(const fs::path& folder, const fs::path& target)
{
    if (::mkdir(folder.c_str(), 0777) != 0 && errno != EEXIST) refuse_folder(target, errno);
}

FileDescriptor locked(const fs::path& folder, const fs::path& target)
{
    std::optional<FileDescriptor> lock = lock_folder(folder, WithoutLocks::allowed);
    if (lock) return std::move(*lock);
    if (errno != EWOULDBLOCK) refuse_folder(target, errno);
    fail(target.string(), ": another process is writing it; expected no other: wait until it ends");
}

/// Removes everything in the folder.
void clear_folder(const fs::path& folder, const fs::path& target)
{
    std::error_code error;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
        if (entry.path().filename() == FOLDER_LOCK) continue;
        fs::remove_all(entry.path(), error);
        if (error) break;
    }
    if (error) fail(target.string(), ": cannot be written: ", folder.string(), ": ", error.message());
}

int exchange_names(const fs::path& one, const fs::path& other)
{
    return ::renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE);
}

/// Tests whether the file system can exchange two names, by trying it with two empty folders.
bool exchanges_names(const fs::path& container, const fs::path& target)
{
    const fs::path one = container / "one", other = container / "other";
    make_folder(one, target);
    make_folder(other, target);
    const bool is_able = exchange_names(one, other) == 0;
    ::rmdir(one.c_str());
    ::rmdir(other.c_str());
    return is_able;
}

std::string free_name(const fs::path& folder)
{
    for (int number = 1;; ++number) {
        std::string name = sentence("v", number);
        if (!is_occupied(folder / name)) return name;
    }
}

}  // namespace

fs::path free_old_name(const fs::path& path)
{
    const fs::path plain = path.has_filename() ? path : path.parent_path();
    for (int number = 1;; ++number) {
        fs::path old = plain;
        old += number == 1 ? ".old" : sentence(".old", number);
        if (!is_occupied(old)) return old;
    }
}

fs::path move_to_old_name(const fs::path& folder, const fs::path& path)
{
    for (;;) {
        const fs::path old = free_old_name(path);
        // rename() never replaces a file by a folder, and replaces a folder only if it is empty.
        if (std::rename(folder.c_str(), old.c_str()) == 0) return old;
        if (errno != EEXIST && errno != ENOTEMPTY && errno != ENOTDIR) refuse_folder(old, errno);
    }
}

void clear_remains(const fs::path& target)
{
    const fs::path container = container_of(link_target(plain_path(target)));
    if (!is_occupied(container)) return;
    std::optional<FileDescriptor> lock = lock_folder(container, WithoutLocks::refused);
    if (!lock) return;
    remove_locked_folder(container, lock);
}

AtomicFolder::AtomicFolder(const fs::path& target)
    : target_(link_target(plain_path(target))), container_(container_of(target_))
{
    std::error_code error;
    fs::create_directories(target_.parent_path(), error);
    if (error) fail(target_.parent_path().string(), ": cannot be created: ", error.message());
    make_folder(container_, target_);
    lock_.emplace(locked(container_, target_));
    unfinished_.emplace(container_.string() + " is left: the next opening or save of its image clears it");
    clear_folder(container_, target_);
    const bool is_new = !is_occupied(target_);
    if (!is_new && !exchanges_names(container_, target_)) inner_ = free_name(target_);
    path_ = container_ / "new";
    make_folder(path_, target_);
}

AtomicFolder::~AtomicFolder()
{
    remove_remains();
}

/// Fails if the folder was moved during writing, after removing the new folders that writing has made at the old place.
void AtomicFolder::expect_in_place()
{
    if (is_lock_of(*lock_, container_)) return;
    remove_remains();
    // rmdir() removes only empty folders: here IMAGE/labels and the project's folder.
    ::rmdir(target_.parent_path().c_str());
    ::rmdir(target_.parent_path().parent_path().c_str());
    fail(target_.string(),
         ": was moved or removed while it was written; expected it to stay: open it where it is now, or "
         "move it back");
}

void AtomicFolder::sync()
{
    expect_in_place();
    if (::syncfs(lock_->number()) != 0) refuse_folder(target_, errno);
}

void AtomicFolder::commit(const std::string& entry)
{
    sync();
    if (inner_.empty())
        exchange(path_);
    else
        enter(entry);
    remove_remains();
}

/// Renames the new content to the name that the old content is to have, and then exchanges the two. In the other order,
/// a process killed in between would leave the old content in the hidden folder, which the next writer deletes.
fs::path AtomicFolder::commit_and_keep_old(const std::string& entry)
{
    fs::path old;
    if (inner_.empty()) {
        sync();
        old = move_to_old_name(path_, target_);
        exchange(old);
    } else {
        old = copy_old();
        enter(entry);
        std::error_code ignored;
        for (const fs::directory_entry& left : fs::directory_iterator(target_, ignored))
            if (left.path().filename() != inner_ && !fs::exists(path_ / left.path().filename(), ignored))
                move_out(left.path());
    }
    remove_remains();
    return old;
}

void AtomicFolder::exchange(const fs::path& with)
{
    const int result =
        is_occupied(target_) ? exchange_names(with, target_) : std::rename(with.c_str(), target_.c_str());
    if (result != 0) {
        const int reason = errno;
        std::error_code ignored;
        fs::remove_all(with, ignored);
        refuse_folder(target_, reason);
    }
    sync_folder(target_);
}

/// Replaces the entry file, which makes the new content valid. Readers only read content that the entry file names.
void AtomicFolder::enter(const std::string& entry)
{
    const std::vector<std::byte> content = read_file(path_ / entry, MAX_ENTRY_BYTES);
    const fs::path moved = target_ / inner_;
    if (std::rename((path_ / inner_).c_str(), moved.c_str()) != 0) refuse_folder(target_, errno);
    sync_folder(moved);
    write_file_atomically(target_ / entry, content);
    collect_temporary_files(target_);
    std::error_code ignored;  // the next version removes what remains
    for (const fs::directory_entry& old : fs::directory_iterator(target_, ignored))
        if (old.is_directory(ignored) && old.path() != moved) move_out(old.path());
}

fs::path AtomicFolder::copy_old()
{
    const fs::path copy = container_ / "old";
    std::error_code error;
    fs::copy(target_, copy, fs::copy_options::recursive | fs::copy_options::copy_symlinks, error);
    if (error) fail(target_.string(), ": cannot be copied, to keep what other programs added: ", error.message());
    sync();
    const fs::path old = move_to_old_name(copy, target_);
    sync_folder(old);
    return old;
}

/// Moves an item of the target into the hidden folder, and then deletes it there. If the process is killed meanwhile,
/// the target contains no partly deleted item.
void AtomicFolder::move_out(const fs::path& inside) const
{
    std::error_code ignored;
    fs::rename(inside, container_ / free_name(container_), ignored);
}

/// Removes the hidden folder. Files that cannot be removed do no harm, since the next writer deletes them.
void AtomicFolder::remove_remains()
{
    if (lock_) remove_locked_folder(container_, lock_);
    unfinished_.reset();
}

}  // namespace shvr
