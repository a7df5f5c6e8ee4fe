// Handles other writers of the work's journal: their claims and their files, and keeps this work's file at its path.

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "engine/annotation/work/work.h"
#include "engine/base/atomic_writer.h"

namespace shvr {

namespace fs = std::filesystem;

/// Handles a claim of the journal by another process. This process's records stay in its file, which the other process
/// should have renamed; otherwise the file is renamed here.
void Work::note_claim()
{
    const std::optional<Holder> other = hold_->successor();
    std::string kept;
    if (journal_) {
        std::string unwritten;
        try {
            journal_->flush();
        } catch (const Error& error) {
            unwritten = sentence("; but ", error.what());
        }
        fs::path name = journal_->present_name();
        if (name.empty()) {
            const fs::path copy = hold_->own_name();
            journal_->copy_to(copy);
            name = rename_to_old(copy, files_.journal).value_or(copy);
        }
        kept = sentence("; what was done here is kept in ", name.string(), unwritten);
    }
    claimed_ = sentence(files_.journal.string(), ": was taken over by ",
                        other ? in_words(*other) : "another process, which has closed it again",
                        "; expected this process to be its only writer", kept);
    claimed_by_ = other ? in_words(*other) : "another process";
    only_looks_ = true;
    hold_->unlock();
}

void Work::expect_hold()
{
    if (!hold_ || hold_->is_kept()) return;
    note_claim();
    throw JournalTaken(claimed_);
}

bool Work::look_for_claim()
{
    if (only_looks_ || !journal_ || !journal_->is_claimed()) return false;
    note_claim();
    return true;
}

/// When work is opened, reports the processes that may still write the journal.
void Work::tell_doubtful(std::vector<Notice>& notices) const
{
    if (!hold_) return;
    for (const Holder& holder : hold_->doubtful())
        notices.push_back(
            {sentence(files_.journal.string(), ": is open for writing in ", in_words(holder),
                      "; expected no other writer; the first change here continues in a copy",
                      is_there(files_.journal) ? " and leaves this file to it, as " + old_of(files_.journal).string()
                                               : std::string()),
             true});
}

/// Begins the journal at once if others may still write it. Records that they wrote before their marks were revoked are
/// read again; later records are not included.
void Work::take_over(std::vector<Notice>& notices)
{
    constexpr int TRIES = 3;
    for (int i = 1; hold_ && !hold_->doubtful().empty() && disputes_.empty(); ++i) try {
            return open_journal();
        } catch (const JournalTaken&) {
            expect_hold();
            if (i == TRIES) throw;
            static_cast<void>(hold_->claim());
            notices = read();
        }
}

/// If it is unknown whether other writers have ended, continues in a copy that only this process writes, and never
/// writes their file again. Null if all of them have closed the journal meanwhile.
std::shared_ptr<Journal> Work::journal_left_to_others()
{
    expect_as_read(files_.journal, scan_);
    if (!hold_->claim()) return nullptr;
    JournalScan copied = is_to_set_aside_ ? JournalScan{} : scan_;
    // Without a journal there is nothing to copy. If another process begins one at this moment, Journal fails.
    if (scan_.inode == 0) return std::make_shared<Journal>(files_.journal, copied, hold_);
    const fs::path own = hold_->own_name();
    ::unlink(own.c_str());  // left by an attempt that failed
    if (copied.inode != 0) {
        AtomicWriter writer(own);
        copy_bytes(scanned_.value(), files_.journal, scan_.end, scan_.head, writer);
        writer.commit();
        struct stat status {};
        if (::stat(own.c_str(), &status) != 0) fail(own.string(), ": cannot be read: ", reason_of(errno));
        copied.inode = status.st_ino;
        copied.file_bytes = copied.end;
        copied.head.clear();
    }
    return std::make_shared<Journal>(files_.journal, copied, hold_, own);
}

/// If the journal's file was removed or replaced, its content would be lost when this process ends. So the journal is
/// restored to its path; a file that has replaced it is kept under another name.
void Work::keep_journal_in_place()
{
    if (journal_->is_in_place()) return;
    journal_->flush();
    const fs::path copy = hold_->own_name();
    journal_->copy_to(copy);
    journal_ = std::make_shared<Journal>(files_.journal, scan_journal(copy), hold_, copy);
}

void Work::set_journal_aside()
{
    expect_as_read(files_.journal, scan_);  // not while another process writes it
    static_cast<void>(set_aside(files_.journal));
    scanned_.reset();
    scan_ = {};
    is_to_set_aside_ = false;
}

}  // namespace shvr
