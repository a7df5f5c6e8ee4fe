// Saves: the state is copied at once, on the work's thread, and then written on any thread.

#include <sys/stat.h>

#include <utility>

#include "engine/annotation/files/mask_image.h"
#include "engine/annotation/files/mask_import.h"
#include "engine/annotation/files/mask_segments.h"
#include "engine/annotation/files/offset_export.h"
#include "engine/annotation/files/offset_import.h"
#include "engine/annotation/work/part_writer.h"
#include "engine/annotation/work/work.h"
#include "engine/annotation/writers/no_replace.h"
#include "engine/base/atomic_writer.h"

namespace shvr {

namespace fs = std::filesystem;

void Work::name_files(const fs::path& mask, const fs::path& trace, const fs::path& density)
{
    const WorkFiles before = files_;
    name_mask(mask);
    if (files_.mask != before.mask) files_.mask_before = shvr::mask_of_header(before);
    files_.trace = trace;
    files_.density = density;
    for (const Part part : PARTS) {
        const fs::path& file = file_of(files_, part);
        if (file == file_of(before, part)) continue;
        digest_of(known_, part).reset();
        seen_[size_t(part)] = {.is_foreign = is_there(file)};
    }
}

void Work::expect_names(const WorkFiles& files) const
{
    if (files.mask.empty() && (files.trace.empty() || holds_any(document_, Part::mask)))
        fail("the session names no file for the mask; expected the key annotation.mask");
    if (files.trace.empty() && holds_any(document_, Part::trace))
        fail("the session names no file for the trace; expected the key annotation.trace");
    if (files.density.empty() && holds_any(document_, Part::offsets))
        fail("the session names no file for density offsets; expected the key annotation.density");
}

Work::Seen Work::seen_at(const fs::path& file)
{
    const std::optional<FileStamp> stamp = stamp_of(file);
    return {.digest = file_digest(file), .stamp = stamp};
}

void Work::note_file(Part part)
{
    note_file(file_of(files_, part), seen_[size_t(part)]);
}

void Work::note_file(const fs::path& file, Seen& seen)
{
    seen = {.stamp = stamp_of(file)};  // even if it cannot be read
    seen = seen_at(file);
}

namespace {

/// Whether a part saved at this path becomes an OME-Zarr folder.
bool is_saved_as_folder(Part part, const fs::path& file)
{
    return part != Part::trace && is_label_image(file) && (part == Part::mask || is_offset_export(file));
}

}  // namespace

std::string write_part(Part part, const Document& document, const WorkFiles& files,
                       const std::vector<LabelImage::Color>& looks, const Journal* journal, Foreign foreign,
                       const Progress& progress)
{
    switch (part) {
        case Part::mask: {
            std::optional<MaskJournal> named;
            if (const auto [number, checksum] = journal ? journal->last_durable() : std::pair<RecordNumber, uint64_t>();
                number > 0)
                named = {files.journal.filename().string(), number, checksum};
            std::string kept = save_mask_as(files.mask, document.mask, files.volume,
                                            {.colors = looks,
                                             .painted_on = files.volume_hash,
                                             .journal = named,
                                             .header = mask_header(mask_of_header(files))},
                                            foreign, progress);
            save_mask_image(files.mask, files.volume_hash, named);
            return kept;
        }
        case Part::trace: save_trace(files.trace, document.trace, space_of(files.volume)); return {};
        case Part::offsets: return save_offsets_as(files.density, document.density, files.volume, foreign, progress);
    }
    return {};
}

/// Writes a part to a new file, which must not exist yet.
void Work::write(Part part, const Document& document, const WorkFiles& files,
                 const std::vector<LabelImage::Color>& looks, const Journal* journal, const Progress& progress)
{
    write_part(part, document, files, looks, journal, Foreign::refused, progress);
}

std::function<void(const WorkFiles&)> Work::copier(std::vector<LabelImage::Color> looks) const
{
    return [document = document_, looks = std::move(looks), before = mask_of_header()](WorkFiles to) {
        to.mask_before = before;
        for (const Part part : PARTS)
            if (!file_of(to, part).empty() && (part == Part::mask || holds_any(document, part)))
                write(part, document, to, looks, nullptr);
    };
}

// ---- Files of other programs ----------------------------------------------------------------------------------------

uint64_t inode_of(const fs::path& path)
{
    struct stat status {};
    return ::stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

KeptFile::KeptFile(const fs::path& path) : path_(path), inode_(inode_of(path))
{
    for (;;) {
        const fs::path old = old_of(path);
        switch (link_to_free(path, old)) {
            case Renaming::done: try { sync_folder(old);
                } catch (...) {
                    std::error_code ignored;
                    fs::remove(old, ignored);
                    throw;
                }
                old_ = old;
                return;
            case Renaming::name_taken: break;  // by another process, just now
            case Renaming::gone: return;
        }
    }
}

KeptFile::~KeptFile()
{
    std::error_code ignored;
    if (old_ && !is_replaced()) fs::remove(*old_, ignored);
}

bool KeptFile::is_replaced() const
{
    return inode_of(path_) != inode_;
}

// ---- A save in progress ---------------------------------------------------------------------------------------------

std::unique_ptr<Work::Saving> Work::begin_save(std::vector<LabelImage::Color> looks)
{
    SHVR_CHECK(!is_saving_, "one save after the other");
    refuse_if_only_looking();
    expect_choice();
    expect_names(files_);
    // begin_journal is also called, and fails, if another process has begun a journal since this process last looked.
    if (scan_.inode != 0 || is_there(files_.journal) || history_.undoable() + history_.redoable() > 0) begin_journal();
    if (journal_) journal_->append(RecordKind::saving, {}, {});
    is_saving_ = true;
    unsaved_since_saving_ = 0;
    touched_since_saving_ = {};
    std::unique_ptr<Saving> saving(new Saving);
    saving->files_ = files_;
    saving->mask_before_ = files_.mask_before;
    saving->document_ = document_;
    saving->looks_ = std::move(looks);
    saving->journal_ = journal_;
    saving->hold_ = hold_;
    saving->touched_ = touched_;
    saving->seen_ = seen_;
    saving->known_ = known_;
    saving->kept_ = kept_;
    saving->last_kept_ = keeps_settings_ ? last_kept_ : 0;
    saving->known_kept_ = known_kept_;
    return saving;
}

/// The mask is always written. Another part is also written when it has become empty, but not if it never had
/// content.
bool Work::Saving::is_to_write(Part part) const
{
    const fs::path& file = file_of(files_, part);
    if (file.empty() || part == Part::mask) return !file.empty();
    return is_there(file) ? touched_[size_t(part)] : holds_any(document_, part) || digest_of(known_, part).has_value();
}

/// Whether a file has content that the journal lacks: found at opening, or written by another program since then.
bool Work::Saving::is_foreign(Part part) const
{
    const fs::path& file = file_of(files_, part);
    const Seen& seen = seen_[size_t(part)];
    if (!is_there(file)) return false;
    if (seen.is_foreign) return true;
    if (const std::optional<FileStamp> stamp = stamp_of(file); stamp && stamp == seen.stamp) return false;
    try {
        return file_digest(file) != seen.digest;
    } catch (const Error&) {
        return true;  // this process has never read it
    }
}

namespace {

/// `old`: where the file of another program is kept; null if there was none.
void note_kept(std::vector<Notice>& notices, Part part, const fs::path& file, const std::optional<fs::path>& old)
{
    if (!old) return;
    notices.push_back(
        {sentence(file.string(), ": was written by another program; expected the ", name_of(part),
                  " as this one knows it; it is kept as ", old->string(), ", and what is saved is this program's"),
         true});
}

}  // namespace

void Work::Saving::write(Part part, const Progress& progress)
{
    const fs::path& file = file_of(files_, part);
    Seen& seen = seen_[size_t(part)];
    if (hold_ && !hold_->is_kept())
        throw JournalTaken(sentence(file.string(), ": is not saved, since another process has taken the journal ",
                                    files_.journal.string(), " over; expected this process to be its only writer"));
    // A file of another program keeps its name until the new file replaces it: a file gets a second name before that,
    // and folders exchange names. If just one of the two is a folder, the old one is moved first.
    const bool is_foreign_now = is_foreign(part);
    const uint64_t inode = inode_of(file);
    std::optional<KeptFile> kept_file;
    if (is_foreign_now) {
        std::error_code ignored;
        const bool is_folder = fs::is_directory(file, ignored);
        std::optional<fs::path> old;
        if (is_folder != is_saved_as_folder(part, file))
            old = set_aside(file);
        else if (!is_folder)
            kept_file.emplace(file);
        note_kept(saved_.notices, part, file, old);
        if (part == Part::mask) files_.mask_before = old.value_or(file);  // the old mask's header is read from here
    }
    // For `kept`, the file may be left from an interrupted save, or another program may have written equal content.
    const bool is_last_save = seen.digest && seen.digest == digest_of(known_, part);
    const Foreign foreign = is_foreign_now ? Foreign::replaced : is_last_save ? Foreign::excluded : Foreign::kept;
    try {
        std::string kept = write_part(part, document_, files_, looks_, journal_.get(), foreign, progress);
        if (!kept.empty()) saved_.notices.push_back({std::move(kept), true});
    } catch (const Error&) {
        const bool is_untouched = inode != 0 && inode_of(file) == inode;
        if (is_foreign_now && is_untouched) throw;  // it is still the other program's
        if (kept_file) note_kept(saved_.notices, part, file, kept_file->old());
        // A partial write is noted as this process's own. An untouched file is not read again, which could take long.
        if (const std::optional<FileStamp> stamp = stamp_of(file); !stamp || stamp != seen.stamp) note_file(file, seen);
        throw;
    }
    if (kept_file) note_kept(saved_.notices, part, file, kept_file->old());
    note_file(file, seen);
    digest_of(known_, part) = seen.digest;
    saved_.files.push_back(file);
}

void Work::Saving::write(const std::function<void()>& save_session, const Progress& progress,
                         const std::function<void()>& save_names)
{
    SHVR_CHECK(!is_written_, "a save is written once");
    if (journal_) journal_->flush();
    constexpr double SHARE = 1.0 / double(PARTS.size() + 1);
    double done = 0.0;
    for (const Part part : PARTS) {
        tell(progress, done);
        if (is_to_write(part)) write(part, part_of(progress, done, done + SHARE));
        done += SHARE;
    }
    tell(progress, done);
    if (save_session) {
        save_session();
        known_.settings = document_.settings.values();
        known_kept_ = last_kept_;
    }
    if (save_names) save_names();
    has_session_ = bool(save_session);
    if (journal_) {
        journal_->append(RecordKind::saved, {}, bytes_of(known_), known_kept_);
        journal_->flush();
    }
    is_written_ = true;
}

Work::Saved Work::end_save(Saving& saving)
{
    SHVR_CHECK(is_saving_, "no save has begun");
    is_saving_ = false;
    // The journal may be opened again before `saving` is destroyed.
    saving.journal_.reset();
    saving.hold_.reset();
    seen_ = saving.seen_;
    for (const Part part : PARTS) digest_of(known_, part) = digest_of(saving.known_, part);
    const bool is_same = files_.mask_before == saving.mask_before_;  // no other mask was taken meanwhile
    if (is_same) files_.mask_before = saving.is_written_ ? fs::path() : saving.files_.mask_before;
    if (!saving.is_written_) return saving.saved_;
    known_.settings = saving.known_.settings;
    known_kept_ = saving.known_kept_;
    if (saving.has_session_ && keeps_settings_) files_.kept = saving.kept_;
    unsaved_ = unsaved_since_saving_;
    misses_files_ = false;
    touched_ = touched_since_saving_;
    if (!only_looks_ && hold_ && !hold_->is_kept()) {
        note_claim();
        saving.saved_.notices.push_back({claimed_, true});
    }
    return saving.saved_;
}

Work::Saved Work::save(std::vector<LabelImage::Color> looks, const std::function<void()>& save_session)
{
    const std::unique_ptr<Saving> saving = begin_save(std::move(looks));
    try {
        saving->write(save_session);
    } catch (...) {
        end_save(*saving);
        throw;
    }
    return end_save(*saving);
}

}  // namespace shvr
