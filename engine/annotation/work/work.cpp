#include "engine/annotation/work/work.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "engine/annotation/files/mask_image.h"
#include "engine/annotation/files/mask_import.h"
#include "engine/annotation/files/offset_import.h"
#include "engine/base/atomic_writer.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

}  // namespace

Work::Work(const Size3& size, VoxelType type) : size_(size), type_(type), document_(empty_document())
{
    begin_history();
}

Work::~Work()
{
    if (!journal_ || !state_.valid()) return;
    state_.wait();
    keep_state();
}

Document Work::empty_document() const
{
    return {.mask = Mask(size_), .trace = {}, .density = DensityField(size_, type_)};
}

void Work::begin_history()
{
    history_ = {};
    fetch_from_journal(history_);
}

void Work::fetch_from_journal(History& history) const
{
    history.fetch_from([this](RecordNumber number) { return changes_at(number); });
}

std::vector<std::byte> Work::content_of(RecordNumber number) const
{
    if (journal_) return journal_->read(number);
    return shvr::content_of(scan_.records.at(number - 1), scanned_.value(), files_.journal);
}

// ---- Working ----

void Work::refuse_if_only_looking() const
{
    if (!only_looks_) return;
    throw JournalTaken(sentence(files_.journal.string(), ": is open to be looked at only",
                                "; expected it open for writing, since this would change it"));
}

void Work::begin_journal()
{
    refuse_if_only_looking();
    expect_choice();  // what is disputed would fit no longer
    if (journal_)
        keep_journal_in_place();
    else
        open_journal();
    record_settings_from_outside();
}

void Work::open_journal()
{
    if (files_.journal.empty()) return;
    if (is_to_set_aside_) set_journal_aside();
    const bool is_new = scan_.records.empty();
    journal_ = std::make_unique<Journal>(files_.journal, scan_);
    scanned_.reset();
    if (is_new)
        begin_records();
    else
        continue_records();
    write_kept();
}

void Work::begin_records()
{
    spaces_.clear();
    space_to_note_.reset();
    journaled_kept_.clear();
    kept_from_outside_ = false;
    journal_->append(RecordKind::subject, {}, bytes_of(JournalSubject{size_, type_, files_.volume_hash}));
    journal_->append(RecordKind::space, {}, bytes_of(JournalSpace{files_.volume.spacing, files_.volume.unit}));
    // Makes the journal readable without the files.
    std::vector<std::byte> state = bytes_of(document_);
    state_bytes_ = state.size();
    journal_->append(RecordKind::state, {}, std::move(state), 1);
    if (!files_.kept.empty()) {
        append_kept(files_.kept, 0);
        known_kept_ = last_kept_;
    }
    record_files(RecordKind::saved, is_fresh_ ? AFRESH : "");
}

/// What opening has found goes in before anything is done.
void Work::continue_records()
{
    if (space_to_note_) {
        const SpaceSince& own = spaces_.back();
        const RecordNumber number = journal_->append(*space_to_note_, {}, bytes_of(own.space));
        SHVR_CHECK(number == own.since, number, " is not ", own.since);
        space_to_note_.reset();
    }
    if (!std::exchange(kept_from_outside_, false)) return;
    append_kept(files_.kept, 0);
    known_kept_ = last_kept_;
    record_files(RecordKind::known);
}

/// Where somebody removed the file, or put another one in its place, what is written to it would be gone with this
/// process: it is put back, and the other one kept.
void Work::keep_journal_in_place()
{
    if (journal_->is_in_place()) return;
    journal_->flush();
    if (is_there(files_.journal)) set_aside(files_.journal);
    journal_->copy_to(files_.journal);
    journal_.reset();
    journal_ = std::make_unique<Journal>(files_.journal, scan_journal(files_.journal));
}

void Work::set_journal_aside()
{
    {
        // Never while another process writes it.
        const Journal nobody_else(files_.journal, scan_);
    }
    scanned_.reset();
    set_aside(files_.journal);
    scan_ = {};
    is_to_set_aside_ = false;
}

RecordNumber Work::record(RecordKind kind, std::string label, std::vector<std::byte> content)
{
    if (!journal_) return 0;
    since_state_bytes_ += content.size();
    ++since_state_steps_;
    return journal_->append(kind, std::move(label), std::move(content));
}

/// What is known of the saved files.
void Work::record_files(RecordKind kind, std::string label)
{
    if (journal_) journal_->append(kind, std::move(label), bytes_of(known_), known_kept_);
}

void Work::touch(std::span<const Change> changes)
{
    const ByKind touch{
        [&](const MaskBrickChange&) { touched_[size_t(Part::mask)] = true; },
        [&](const TraceChange&) { touched_[size_t(Part::trace)] = true; },
        [&](const DensityBrickChange&) { touched_[size_t(Part::offsets)] = true; },
        [](const SettingChange&) {},
    };
    for (const Change& change : changes) std::visit(touch, change);
}

void Work::note_step()
{
    keep_state();
    history_.shrink(limits_.history_bytes, journal_ ? journal_->durable() : 0);
}

const Command* Work::perform(Command command)
{
    if (command.changes.empty()) return nullptr;
    begin_journal();
    const RecordNumber number = record(RecordKind::command, command.label, bytes_of(command.changes));
    touch(command.changes);
    const Command* const performed = history_.perform(document_, std::move(command), number);
    ++unsaved_;
    note_step();
    return performed;
}

void Work::extend(std::vector<Change> changes)
{
    if (changes.empty()) return;
    const RecordNumber number = record(RecordKind::extension, {}, bytes_of(changes));
    touch(changes);
    history_.extend(document_, std::move(changes), number);
    unsaved_ = std::max<size_t>(unsaved_, 1);
    note_step();
}

const Command* Work::undo()
{
    return history_.undoable() == 0 ? nullptr : go(&History::undo, RecordKind::undo);
}

const Command* Work::redo()
{
    return history_.redoable() == 0 ? nullptr : go(&History::redo, RecordKind::redo);
}

const Command* Work::go(const Command* (History::*way)(Document&), RecordKind kind)
{
    begin_journal();
    const Command* const command = (history_.*way)(document_);
    if (!command) return nullptr;  // the step before has just been recorded
    touch(command->changes);
    record(kind);
    ++unsaved_;
    note_step();
    return command;
}

void Work::keep_state()
{
    if (!journal_) return;
    if (state_.valid()) {
        if (state_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
        std::vector<std::byte> state = state_.get();
        state_bytes_ = state.size();
        // Larger states are not journalled.
        if (state.size() <= MAX_RECORD_BYTES) journal_->append(RecordKind::state, {}, std::move(state), state_about_);
        if (!kept_.empty()) append_kept(kept_, 0);
        return;
    }
    if (since_state_bytes_ < std::max(limits_.bytes_between_states, 2 * state_bytes_) &&
        since_state_steps_ < limits_.steps_between_states)
        return;
    since_state_bytes_ = since_state_steps_ = 0;
    state_about_ = journal_->last();
    state_ = std::async(std::launch::async, [document = document_] { return bytes_of(document); });
}

// ---- Saving ----

void Work::name_files(const fs::path& mask, const fs::path& trace, const fs::path& density)
{
    const WorkFiles before = files_;
    files_.mask = mask;
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

/// The mask always; another part that has become empty is written as empty, but if there never was one, no file is.
bool Work::is_to_write(Part part) const
{
    const fs::path& file = file_of(files_, part);
    if (file.empty() || part == Part::mask) return !file.empty();
    return is_there(file) ? touched_[size_t(part)] : holds_any(document_, part) || digest_of(known_, part).has_value();
}

/// Whether a file holds what the journal does not: found so at opening, or written by others since.
bool Work::is_foreign(Part part) const
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

void Work::note_file(Part part)
{
    Seen& seen = seen_[size_t(part)];
    seen = {.stamp = stamp_of(file_of(files_, part))};  // also where it cannot be read
    seen = seen_at(file_of(files_, part));
}

Work::Seen Work::seen_at(const fs::path& file)
{
    const std::optional<FileStamp> stamp = stamp_of(file);
    return {.digest = file_digest(file), .stamp = stamp};
}

/// `journal`: the one that the mask names, beside `files`; null where there is none.
void Work::write(Part part, const WorkFiles& files, std::vector<LabelImage::Color> looks, const Journal* journal) const
{
    switch (part) {
        case Part::mask: {
            std::optional<MaskJournal> named;
            if (const auto [number, checksum] = journal ? journal->last_durable() : std::pair<RecordNumber, uint64_t>();
                number > 0)
                named = {files.journal.filename().string(), number, checksum};
            save_mask_as(files.mask, document_.mask, files.volume,
                         {.colors = std::move(looks), .painted_on = files.volume_hash, .journal = named});
            save_mask_image(files.mask, files.volume_hash, named);
            return;
        }
        case Part::trace: save_trace(files.trace, document_.trace, space_of(files.volume)); return;
        case Part::offsets: save_offsets_as(files.density, document_.density, files.volume); return;
    }
}

Work::Saved Work::save(std::vector<LabelImage::Color> looks, const std::function<void()>& save_session)
{
    refuse_if_only_looking();
    expect_choice();
    expect_names(files_);
    // Also where another process has begun a journal since this one looked: then this one is refused.
    if (scan_.inode != 0 || is_there(files_.journal) || history_.undoable() + history_.redoable() > 0) begin_journal();
    if (journal_) {
        journal_->append(RecordKind::saving, {}, {});
        journal_->flush();
    }
    Saved saved;
    for (const Part part : PARTS) {
        if (!is_to_write(part)) continue;
        const fs::path& file = file_of(files_, part);
        if (is_foreign(part)) {
            const fs::path old = set_aside(file);
            saved.notices.push_back({sentence(file.string(), ": was written by another program; expected the ",
                                              name_of(part), " as this one knows it; it is kept as ", old.string(),
                                              ", and what is saved is this program's"),
                                     true});
        }
        try {
            write(part, files_, looks, journal_.get());
        } catch (const Error&) {
            note_file(part);  // whatever of it was done is this process's
            throw;
        }
        note_file(part);
        digest_of(known_, part) = seen_[size_t(part)].digest;
        saved.files.push_back(file);
    }
    if (save_session) {
        save_session();
        known_.settings = document_.settings.values();
        known_kept_ = keeps_settings_ ? last_kept_ : 0;
    }
    record_files(RecordKind::saved);
    flush();
    if (save_session && keeps_settings_) files_.kept = kept_;
    unsaved_ = 0;
    misses_files_ = false;
    touched_ = {};
    return saved;
}

void Work::save_copy(const WorkFiles& to, std::vector<LabelImage::Color> looks) const
{
    for (const Part part : PARTS)
        if (!file_of(to, part).empty() && (part == Part::mask || holds_any(document_, part)))
            write(part, to, looks, nullptr);
}

bool Work::is_kept() const
{
    if (files_.journal.empty()) return unsaved_ == 0;
    if (!journal_) return true;
    try {
        journal_->flush();
        return journal_->is_in_place();
    } catch (const Error&) {
        return false;
    }
}

void Work::settle()
{
    if (!journal_) return;
    if (state_.valid()) {
        state_.wait();
        keep_state();
    }
    journal_->flush();
}

void Work::flush()
{
    if (journal_) journal_->flush();
}

Work::JournalState Work::journal() const
{
    if (!journal_) return {.bytes = is_to_set_aside_ ? 0 : scan_.file_bytes, .failure = {}};
    return {journal_->bytes(), journal_->failure()};
}

}  // namespace shvr
