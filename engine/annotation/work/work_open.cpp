// Opens work: reads the journal and the saved files next to it, and decides which of them to use if they differ.

#include <fcntl.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <set>
#include <thread>
#include <utility>

#include "engine/annotation/files/mask_image.h"
#include "engine/annotation/files/mask_import.h"
#include "engine/annotation/files/volume_place.h"
#include "engine/annotation/work/journal_head.h"
#include "engine/annotation/work/work.h"
#include "engine/base/atomic_writer.h"
#include "engine/base/text.h"
#include "engine/projects/atomic_folder.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

bool is_step(RecordKind kind)
{
    return kind == RecordKind::command || kind == RecordKind::undo || kind == RecordKind::redo;
}

/// Counts steps since the last save. A save contains the state at its start, so steps made during the save count, too.
size_t steps_since_save(const JournalScan& scan)
{
    size_t steps = 0;
    std::optional<size_t> since_saving;
    for (const JournalRecord& record : scan.records) {
        if (record.kind == RecordKind::saving) since_saving = 0;
        if (record.kind == RecordKind::saved) steps = std::exchange(since_saving, {}).value_or(0);
        const bool continues = record.kind == RecordKind::extension;
        if (!is_step(record.kind) && !continues) continue;
        steps = continues ? std::max<size_t>(steps, 1) : steps + 1;
        if (since_saving) since_saving = continues ? std::max<size_t>(*since_saving, 1) : *since_saving + 1;
    }
    return steps;
}

bool tells_files(RecordKind kind)
{
    return kind == RecordKind::saved || kind == RecordKind::known;
}

bool holds_state(const JournalScan& scan)
{
    return std::ranges::any_of(scan.records, [](const auto& record) { return record.kind == RecordKind::state; });
}

fs::path plain(const fs::path& path)
{
    return fs::absolute(path).lexically_normal();
}

/// Whether MASK.json says that the mask was saved with this journal, or with another journal at this path.
bool names_journal(const WorkFiles& files)
{
    const std::optional<MaskJournal> named = journal_of_mask(files.mask);
    return named && named->name == files.journal.filename().string();
}

}  // namespace

std::optional<Notice> note_missing_journal(const WorkFiles& files)
{
    if (files.journal.empty() || is_there(files.journal) || !names_journal(files)) return std::nullopt;
    return Notice{sentence(files.journal.string(), ": is missing; expected the history and what was not saved, since ",
                           journal_is_named_in(files.mask).string(),
                           " names it; the saved files are taken; put it back before anything is painted, or go on "
                           "without"),
                  true};
}

std::vector<Notice> Work::open(const WorkFiles& files, const Opening& opening)
{
    constexpr int TRIES = 20;
    constexpr std::chrono::milliseconds TURN(50);
    SHVR_CHECK(!journal_ && history_.undoable() == 0, "work has begun");
    files_ = files;
    name_mask(files.mask);
    only_looks_ = opening.only_look;
    why_only_looks_ = opening.why_only_look;
    opening_progress_ = opening.progress;
    program_ = opening.program;
    keeps_settings_ = !files.kept.empty();
    kept_ = files.kept;
    const bool is_given =
        opening.hold && plain(opening.hold->journal()) == plain(files.journal) && opening.hold->is_kept();
    if (!only_looks_) {
        hold_ = is_given ? opening.hold : Hold::take(files.journal, opening.program);
        std::set<fs::path> folders;  // where killed programs may have left the temporary files of a save
        for (const fs::path& file : {files.journal, files.mask, files.trace, files.density})
            if (!file.empty()) folders.insert(file.parent_path());
        for (const fs::path& folder : folders) collect_temporary_files(folder);
        for (const fs::path& image : {files.mask, files.density})
            if (!image.empty()) clear_remains(image);
    }
    is_fresh_ = opening.start == Start::fresh;
    takes_files_ = opening.belief == Belief::files || is_fresh_;
    std::vector<Notice> notices = read();
    // Another process may be in the middle of a save, so changed files are read again before they count as disputes.
    for (int i = 0; i < TRIES && only_looks_ && !disputes_.empty() && holder_of(files.journal); ++i) {
        std::this_thread::sleep_for(TURN);
        notices = read();
    }
    std::vector<Notice> told;
    if (!only_looks_) tell_mask_to_read(told);
    tell_doubtful(told);
    if (opening.takes_over && !only_looks_) take_over(notices);
    opening_progress_ = {};
    notices.insert(notices.end(), told.begin(), told.end());
    for (Notice& notice : choose(opening.belief).notices) notices.push_back(std::move(notice));
    return notices;
}

/// A mask in a read-only format is saved as a label image next to it.
void Work::name_mask(const fs::path& stated)
{
    files_.mask = saved_mask_path(stated);
    files_.mask_to_read = files_.mask == stated ? fs::path() : stated;
}

/// When work is opened, reports which mask is read if its format is read-only, before the user paints anything.
void Work::tell_mask_to_read(std::vector<Notice>& notices) const
{
    if (is_in_archive(files_.mask))
        notices.push_back({sentence(files_.mask.string(),
                                    ": lies in an archive, which is only read; to save what is "
                                    "painted, name a mask outside it, or save under another "
                                    "name")});
    if (files_.mask_to_read.empty()) return;
    const std::string name = files_.mask_to_read.string();
    if (is_there(files_.mask))
        notices.push_back({sentence(name, ": has a format in which masks are only read; ", files_.mask.string(),
                                    " next to it, where the mask is kept, is taken instead")});
    else
        notices.push_back(
            {sentence(name, ": has a format in which masks are only read; what is painted will be kept in ",
                      files_.mask.string(), ", and this file stays as it is")});
}

std::vector<Notice> Work::read()
{
    if (!is_fresh_) return open_once();
    open_fresh();
    return {};
}

std::vector<Notice> Work::open_once()
{
    document_ = empty_document();
    begin_history();
    disputes_.clear();
    settings_from_outside_.clear();
    journaled_kept_.clear();
    last_kept_ = known_kept_ = 0;
    kept_from_outside_ = false;
    spaces_.clear();
    space_to_note_.reset();
    touched_ = {};
    unsaved_ = 0;
    misses_files_ = is_to_set_aside_ = false;
    read_journal();
    if (!scan_.records.empty()) check_subject();
    const std::string damage = holds_state(scan_) ? replay() : std::string();
    if (!holds_state(scan_)) return open_from_files(damage);

    std::vector<Notice> notices;
    const std::string name = files_.journal.string();
    if (!damage.empty()) notices.push_back({sentence(name, ": ", damage, "; what comes before is used"), true});
    // While another process is writing, a partial record at the end is not damage.
    if (scan_.end < scan_.file_bytes && !(only_looks_ && holder_of(files_.journal)))
        notices.push_back({sentence(name, ": its last ", scan_.file_bytes - scan_.end,
                                    " bytes are an incomplete or damaged record; expected complete ones; the ",
                                    scan_.records.size(), " records before are used"),
                           true});
    if (!scan_.head.empty())
        notices.push_back({sentence(name, ": its first bytes are damaged; expected them as their repetition has them, ",
                                    "which is used; nothing is lost, and the next writing repairs them")});
    unsaved_ = steps_since_save(scan_);
    touched_.fill(unsaved_ > 0);
    if (unsaved_ > 0)
        notices.push_back({sentence(name, ": holds ", unsaved_, unsaved_ == 1 ? " step that was" : " steps that were",
                                    " not saved; none of them is lost")});
    tell_spacing(notices);
    look_at_files(notices);
    compare_settings(notices);
    compare_kept_settings(notices);
    return notices;
}

void Work::read_journal()
{
    scanned_.reset();
    scan_ = {};
    if (!is_there(files_.journal)) return;
    scanned_.emplace(::open(files_.journal.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (!*scanned_) fail(files_.journal.string(), ": cannot be opened: ", reason_of(errno));
    try {
        scan_ = scan_journal(files_.journal);
    } catch (const JournalDamaged&) {
        if (!takes_files_) throw;
        struct stat status {};
        if (::fstat(scanned_->number(), &status) != 0) throw;
        scan_.inode = status.st_ino;
        scan_.file_bytes = uint64_t(status.st_size);
    }
}

/// Treats existing files as those of earlier work. They are renamed and kept if the earlier work's journal lacks them.
void Work::open_fresh()
{
    read_journal();
    known_ = {};
    is_to_set_aside_ = scan_.file_bytes > 0;
    touched_.fill(true);
    document_.settings = Settings(files_.settings);
    known_.settings = files_.settings;
    SavedFiles saved;
    for (RecordNumber number = scan_.records.size(); number > 0; --number)
        if (tells_files(scan_.records[number - 1].kind)) {
            saved = saved_files_of(content_of(number));
            break;
        }
    for (const Part part : PARTS) {
        note_file(part);
        Seen& seen = seen_[size_t(part)];
        seen.is_foreign = is_there(file_of(files_, part)) && seen.digest != digest_of(saved, part);
        if (!seen.is_foreign) digest_of(known_, part) = seen.digest;
    }
}

/// Opens work without a journal, or with a journal that has no state. `damage`: why there is no state, if known.
std::vector<Notice> Work::open_from_files(const std::string& damage)
{
    std::vector<Notice> notices;
    const std::string name = files_.journal.string();
    const bool was_there = scan_.inode != 0;
    document_.settings = Settings(files_.settings);
    known_.settings = files_.settings;
    is_to_set_aside_ = !scan_.records.empty() || scan_.end < scan_.file_bytes;
    if (!was_there) {
        if (std::optional<Notice> notice = note_missing_journal(files_)) notices.push_back(std::move(*notice));
    } else if (is_to_set_aside_ || scan_.file_bytes == 0 || names_journal(files_))
        notices.push_back(
            {sentence(name, ": holds ", scan_.file_bytes, " bytes and no whole state of the work",
                      damage.empty() ? "" : " (" + damage + ")",
                      "; expected the history and what was not saved; the saved files are taken",
                      is_to_set_aside_ ? ", and the first command keeps this file as " + old_of(files_.journal).string()
                                       : std::string()),
             true});
    for (const Part part : PARTS) {
        note_file(part);
        // Only a mask may be in an archive, as a label image; trace and offsets are by default next to the mask.
        const fs::path &file = file_to_read(files_, part), &saved = file_of(files_, part);
        if (is_there(file) || (part == Part::mask && is_in_archive(file))) {
            const LoadNotes notes = load(part, files_, document_);
            for (const std::string& loss : notes.losses) {
                // The document lacks data of the file, so a save must not overwrite the file.
                seen_[size_t(part)].is_foreign = file == saved;
                const std::string how_kept = "; the next save keeps this file as " + old_of(saved).string();
                notices.push_back({sentence(loss, file == saved ? how_kept : std::string()), true});
            }
            for (const std::string& remark : notes.remarks) notices.push_back({remark});
        }
        digest_of(known_, part) = seen_[size_t(part)].digest;
    }
    return notices;
}

void Work::check_subject() const
{
    const std::string name = files_.journal.string();
    JournalSubject found;
    try {
        found = subject_of(content_of(1));
    } catch (const Error& error) {
        fail(name, ": does not state its volume: ", error.what());
    }
    const auto volume_in_words = [](const Size3& size, VoxelType type) {
        return sentence(size.x, "x", size.y, "x", size.z, " voxels of ", name_of(type));
    };
    if (found.size != size_ || found.type != type_)
        fail(name, ": is of a volume of ", volume_in_words(found.size, found.type), "; expected ",
             volume_in_words(size_, type_));
    const bool is_named = found.image.empty() || files_.volume_hash.empty() || found.image == files_.volume_hash ||
                          (files_.is_other_name && files_.is_other_name(found.image));
    if (!is_named) fail(name, ": is of an image with the hash ", found.image, "; expected ", files_.volume_hash);
}

// ---- Replaying ------------------------------------------------------------------------------------------------------

std::string Work::replay()
{
    std::string damage;
    for (;;) {
        RecordNumber at = 0;
        try {
            read_spaces(at);
            Replayed whole = replayed(scan_, scan_.records.size(), at);
            document_ = std::move(whole.document);
            history_ = std::move(whole.history);
            return damage;
        } catch (const Stopped&) {
            throw;
        } catch (const Error& error) {
            scan_.cut(at - 1);
            damage = sentence("record ", at, " cannot be applied: ", error.what());
            if (!holds_state(scan_)) return damage;
        }
    }
}

/// Returns the work as of record `last`. On failure, `at` is the record that could not be replayed.
Work::Replayed Work::replayed(const JournalScan& scan, RecordNumber last, RecordNumber& at) const
{
    Replayed work{empty_document(), {}};
    fetch_from_journal(work.history);
    at = last;
    while (at > 0 && scan.records[at - 1].kind != RecordKind::state) --at;
    const RecordNumber state = at;
    const auto replay_one = [&](RecordNumber known) {
        const JournalRecord& record = scan.records[at - 1];
        const bool is_noted = at <= known;
        const auto apply = [&] {
            if (!is_noted) apply_if_it_fits(work.document, changes_at(at), Direction::forwards);
        };
        switch (record.kind) {
            case RecordKind::command:
                apply();
                work.history.note(record.label, at);
                break;
            case RecordKind::extension:
                apply();
                work.history.note_extension(at);
                break;
            case RecordKind::undo:
                if (is_noted)
                    work.history.note_undo();
                else if (!work.history.undo(work.document))
                    fail("more commands are undone than were done");
                break;
            case RecordKind::redo:
                if (is_noted)
                    work.history.note_redo();
                else if (!work.history.redo(work.document))
                    fail("more commands are redone than were undone");
                break;
            default: break;  // states, saves, and kinds that this version does not know
        }
    };
    RecordNumber known = 0;
    if (state > 0) {
        known = scan.records[state - 1].about;
        if (known >= state) fail("a state is of record ", known, " behind it");
        work.document =
            document_of(content_of(state), empty_document(), [&](Change& change) { bring_to_spacing(change, state); });
    }
    constexpr RecordNumber RECORDS_TOLD = 64;
    for (at = 1; at <= last; ++at) {
        if (at % RECORDS_TOLD == 0) tell(opening_progress_, double(at) / double(last));
        replay_one(known);
    }
    return work;
}

// ---- The saved files next to the journal ----------------------------------------------------------------------------

void Work::look_at_files(std::vector<Notice>& notices)
{
    known_ = {};
    for (RecordNumber number = scan_.records.size(); number > 0; --number)
        if (tells_files(scan_.records[number - 1].kind)) {
            try {
                known_kept_ = scan_.records[number - 1].about;
                known_ = saved_files_of(content_of(number));
            } catch (const Error&) {  // if this record is unreadable, every file is compared with the work
            }
            break;
        }
    for (const Part part : PARTS)
        if (!file_of(files_, part).empty()) look_at_file(part, notices);
}

void Work::look_at_file(Part part, std::vector<Notice>& notices)
{
    const fs::path& file = file_of(files_, part);
    const std::string journal_holds =
        sentence("the journal ", files_.journal.string(), " holds the ", name_of(part), " and is taken");
    Seen& seen = seen_[size_t(part)];
    bool& is_touched = touched_[size_t(part)];
    const auto keep_unreadable = [&](const Error& error) {
        seen.is_foreign = is_touched = misses_files_ = true;
        notices.push_back(
            {sentence(error.what(), "; ", journal_holds, "; the next save keeps this file as ", old_of(file).string()),
             true});
    };
    try {
        note_file(part);
    } catch (const Error& error) {
        return keep_unreadable(error);
    }
    if (seen.digest == digest_of(known_, part)) {
        if (part == Part::mask && seen.digest) look_at_mask_image(notices);
        return;
    }
    if (!seen.digest) {
        is_touched = misses_files_ = true;
        notices.push_back({sentence(file.string(), ": is missing; expected the ", name_of(part), " as it was saved; ",
                                    journal_holds, "; saving writes the file again"),
                           true});
        return;
    }
    Document found = empty_document();
    try {
        const LoadNotes notes = load(part, files_, found);
        for (const std::string& loss : notes.losses) notices.push_back({loss, true});
        for (const std::string& remark : notes.remarks) notices.push_back({remark});
    } catch (const Error& error) {
        return keep_unreadable(error);
    }
    if (is_as_written(part, found)) return;
    seen.is_foreign = is_touched = true;
    disputes_.push_back({part, file,
                         sentence(file.string(), ": ", what_happened_to(part), "; expected the ", name_of(part),
                                  " as the journal ", files_.journal.string(), " knows it saved"),
                         changes_between(part, document_, found)});
}

void Work::look_at_mask_image(std::vector<Notice>& notices) const
{
    try {
        check_mask_image(files_.mask, files_.volume_hash, files_.is_other_name);
    } catch (const Error& error) {
        notices.push_back({sentence(error.what(), "; the journal ", files_.journal.string(),
                                    " is of this volume and is taken; saving writes this file anew"),
                           true});
    }
}

/// Returns the record at which the save that ended with the record `saved` began, and whose state the save holds.
RecordNumber Work::begin_of_save(const JournalScan& scan, RecordNumber saved)
{
    for (RecordNumber number = saved - 1; number > 0; --number) {
        const RecordKind kind = scan.records[number - 1].kind;
        if (kind == RecordKind::saving) return number;
        if (kind == RecordKind::saved) break;
    }
    return saved;  // the first `saved` record lists files as found, without a save
}

/// The states that saves may have written: that of the last completed save, and those of all saves begun since then.
std::vector<Document> Work::documents_at_saves() const
{
    constexpr size_t MAX_SAVES = 512;  // each is replayed
    std::vector<Document> documents{document_};
    bool is_changed = false;  // since the state before
    for (RecordNumber number = scan_.records.size(); number > 0 && documents.size() < MAX_SAVES; --number) {
        const RecordKind kind = scan_.records[number - 1].kind;
        const bool was_finished = kind == RecordKind::saved;
        if (kind != RecordKind::saving && !was_finished) {
            is_changed |= uint32_t(kind) < FIRST_ADDITION;
            continue;
        }
        if (!std::exchange(is_changed, false) && !was_finished) continue;
        RecordNumber at = 0;
        documents.push_back(replayed(scan_, was_finished ? begin_of_save(scan_, number) : number, at).document);
        if (was_finished) break;
    }
    return documents;
}

/// Whether a save, perhaps an interrupted one, may have written the content of a file that has unexpected bytes.
bool Work::is_as_written(Part part, const Document& found) const
{
    const auto is_equal = [&](const Document& document) {
        if (changes_between(part, document, found).empty()) return true;
        return part == Part::trace && trace_digest(files_, document.trace) == seen_[size_t(part)].digest;
    };
    return std::ranges::any_of(documents_at_saves(), is_equal);
}

std::string Work::what_happened_to(Part part) const
{
    if (part == Part::mask && lacks_record_of_mask())
        return sentence("was saved by a later state of the journal, or with another one, as ",
                        journal_is_named_in(files_.mask).string(), " says");
    size_t saves = 0;
    for (RecordNumber number = scan_.records.size(); number > 0; --number) {
        if (scan_.records[number - 1].kind != RecordKind::saved) continue;
        try {
            const SavedFiles files = saved_files_of(content_of(number));
            if (digest_of(files, part) == seen_[size_t(part)].digest)
                return sentence("is as it was saved earlier, ", saves, saves == 1 ? " save" : " saves",
                                " before the last");
        } catch (const Error&) {  // no information
        }
        ++saves;
    }
    return digest_of(known_, part) ? "was changed by another program" : "was put there by another program";
}

/// Whether MASK.json names a record that this journal does not have.
bool Work::lacks_record_of_mask() const
{
    const std::optional<MaskJournal> named = journal_of_mask(files_.mask);
    return named && (named->record > scan_.records.size() ||
                     scan_.records[size_t(named->record) - 1].checksum != named->checksum);
}

// ---- Choosing -------------------------------------------------------------------------------------------------------

void Work::expect_choice() const
{
    std::string texts;
    for (const Dispute& dispute : disputes_) texts += (texts.empty() ? "" : "; ") + dispute.text;
    if (!texts.empty()) throw Disputed(texts);
}

Work::Choice Work::choose(Belief belief)
{
    Choice choice;
    if (belief == Belief::ask || disputes_.empty()) return choice;
    const std::vector<Dispute> disputes = std::exchange(disputes_, {});
    if (belief == Belief::journal) {
        for (const Dispute& dispute : disputes)
            choice.notices.push_back(
                {sentence(dispute.text, "; the journal is taken, and the next save keeps the file as ",
                          old_of(dispute.file).string())});
        return choice;
    }
    Command command{"files that were changed", {}};
    for (const Dispute& dispute : disputes) {
        command.changes.insert(command.changes.end(), dispute.differences.begin(), dispute.differences.end());
        choice.notices.push_back({sentence(dispute.text, "; the file is taken, as a step that undo takes back")});
    }
    if (only_looks_) {
        choice.command = history_.perform(document_, std::move(command));
        return choice;
    }
    choice.command = perform(std::move(command));
    for (const Dispute& dispute : disputes) {
        Seen& seen = seen_[size_t(dispute.part)];
        digest_of(known_, dispute.part) = seen.digest;
        seen.is_foreign = false;
    }
    record_files(RecordKind::known);
    return choice;
}

}  // namespace shvr
