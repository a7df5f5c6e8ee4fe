// Other writers of the work's journal: their claims, their files, and the place of this one.

#include <sys/stat.h>

#include <utility>

#include "engine/annotation/work/work.h"
#include "engine/base/atomic_writer.h"

namespace shvr {

namespace fs = std::filesystem;

/// Another process has claimed the journal: what this one did stays under the name that the other gave it, or gets one.
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
        if (name.empty()) journal_->copy_to(name = old_of(files_.journal));
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

/// What is told at opening about processes that may still write the journal.
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

/// Where it is unknown whether others have ended, their file is never written again by this process: it continues in a
/// copy, which it alone created.
void Work::leave_journal_to_others()
{
    expect_as_read(files_.journal, scan_);
    if (!hold_->claim()) return;
    if (is_to_set_aside_) {
        set_aside(files_.journal);
        scan_ = {};
        is_to_set_aside_ = false;
    } else if (scan_.inode != 0) {
        const fs::path copy = hold_->own_name();
        {
            AtomicWriter writer(copy);
            copy_bytes(scanned_.value(), files_.journal, scan_.end, scan_.head, writer);
            writer.commit();
        }
        put_in_place(copy, files_.journal);
        struct stat status {};
        if (::stat(files_.journal.c_str(), &status) != 0) fail(files_.journal.string(), ": cannot be read");
        scan_.inode = status.st_ino;
        scan_.file_bytes = scan_.end;
        scan_.head.clear();
    }
    scanned_.reset();
    hold_->end_claim();
}

/// If the journal's file was removed or replaced, anything written to it would be lost when this process ends. So the
/// journal is restored to its path; a file that has replaced it is kept under another name.
void Work::keep_journal_in_place()
{
    if (journal_->is_in_place()) return;
    journal_->flush();
    const fs::path copy = hold_->own_name();
    journal_->copy_to(copy);
    put_in_place(copy, files_.journal);
    journal_.reset();
    journal_ = std::make_shared<Journal>(files_.journal, scan_journal(files_.journal), hold_);
}

void Work::set_journal_aside()
{
    expect_as_read(files_.journal, scan_);  // not while another process writes it
    scanned_.reset();
    set_aside(files_.journal);
    scan_ = {};
    is_to_set_aside_ = false;
}

}  // namespace shvr
