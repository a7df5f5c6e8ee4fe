#include "engine/annotation/work/work.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <utility>

#include "engine/annotation/work/journal_head.h"

namespace shvr {

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
    return shvr::content_of(scan_.records.at(number - 1), scanned_.value(), files_.journal, scan_.head);
}

// ---- Working ----

void Work::refuse_if_only_looking() const
{
    if (!only_looks_) return;
    if (!claimed_.empty()) throw JournalTaken(claimed_);
    if (!why_only_looks_.empty()) throw JournalTaken(why_only_looks_);
    throw JournalTaken(sentence(files_.journal.string(), ": is open to be looked at only",
                                "; expected it open for writing, since this would change it"));
}

void Work::begin_journal()
{
    refuse_if_only_looking();
    expect_hold();
    expect_choice();  // disputed differences would no longer fit
    if (is_saving_as_) fail("the work is being saved under another name; expected that to have ended");
    try {
        if (journal_)
            keep_journal_in_place();
        else
            open_journal();
    } catch (const Error&) {
        expect_hold();  // if the journal was claimed, fails with that reason instead
        throw;
    }
    record_settings_from_outside();
}

void Work::open_journal()
{
    if (files_.journal.empty()) return;
    int error = 0;
    if (!hold_) hold_ = Hold::take(files_.journal, program_, error);
    if (!hold_) fail(files_.journal.string(), ": cannot be written: ", reason_of(error));
    std::shared_ptr<Journal> left;
    if (!hold_->doubtful().empty()) left = journal_left_to_others();
    if (!left && is_to_set_aside_) set_journal_aside();
    if (is_to_set_aside_) scan_ = {};
    is_to_set_aside_ = false;
    const bool is_new = scan_.records.empty();
    journal_ = left ? left : std::make_shared<Journal>(files_.journal, scan_, hold_);
    scanned_.reset();
    hold_->end_claim();
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
    times_.clear();
    std::vector<std::byte> subject = bytes_of(JournalSubject{size_, type_, files_.volume_hash});
    std::vector<std::byte> repeated = repeated_head(subject);
    journal_->append(RecordKind::subject, {}, std::move(subject));
    journal_->append(RecordKind::head, {}, std::move(repeated));
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

/// Writes records about changes found when the work was opened, before any other record.
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

RecordNumber Work::record(RecordKind kind, std::string label, std::vector<std::byte> content)
{
    if (!journal_) return 0;
    note_time();
    since_state_bytes_ += content.size();
    ++since_state_steps_;
    return journal_->append(kind, std::move(label), std::move(content));
}

/// Notes the time of the record that follows, unless the last note is from the same tenth of a second. So a long stroke
/// adds at most ten notes of 48 bytes per second.
void Work::note_time()
{
    constexpr int64_t STEP_MS = 100;
    using namespace std::chrono;
    const int64_t now =
        now_ms_ ? now_ms_() : duration_cast<milliseconds>(system_clock::now().time_since_epoch()).count();
    if (!times_.empty() && std::abs(now - times_.back().time_ms) < STEP_MS) return;
    times_.push_back({journal_->append(RecordKind::time, {}, bytes_of(JournalTime{now})), now});
}

std::optional<int64_t> Work::time_of(size_t step) const
{
    const RecordNumber record = history_.record_of(step);
    const auto after = std::ranges::upper_bound(times_, record, {}, [](const TimeSince& each) { return each.since; });
    if (after != times_.begin()) return std::prev(after)->time_ms;
    RecordNumber number = std::min<RecordNumber>(record, scan_.records.size());
    while (number > 0 && scan_.records[number - 1].kind != RecordKind::time) --number;
    if (number == 0) return std::nullopt;
    try {
        return shvr::time_of(content_of(number)).time_ms;
    } catch (const Error& error) {
        fail(files_.journal.string(), ": record ", number, " holds no time: ", error.what());
    }
}

/// Records the known state of the saved files.
void Work::record_files(RecordKind kind, std::string label)
{
    if (journal_) journal_->append(kind, std::move(label), bytes_of(known_), known_kept_);
}

void Work::touch(std::span<const Change> changes)
{
    const auto note = [&](Part part) { touched_[size_t(part)] = touched_since_saving_[size_t(part)] = true; };
    const ByKind touch{
        [&](const MaskBrickChange&) { note(Part::mask); },
        [&](const TraceChange&) { note(Part::trace); },
        [&](const DensityBrickChange&) { note(Part::offsets); },
        [](const SettingChange&) {},
    };
    for (const Change& change : changes) std::visit(touch, change);
}

void Work::note_unsaved(size_t steps)
{
    for (size_t* const count : {&unsaved_, &unsaved_since_saving_})
        *count = steps == 0 ? std::max<size_t>(*count, 1) : *count + steps;
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
    note_unsaved(1);
    note_step();
    return performed;
}

void Work::extend(std::vector<Change> changes)
{
    if (changes.empty()) return;
    const RecordNumber number = record(RecordKind::extension, {}, bytes_of(changes));
    touch(changes);
    history_.extend(document_, std::move(changes), number);
    note_unsaved(0);
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
    if (!command) return nullptr;  // the preceding step has just been recorded
    touch(command->changes);
    record(kind);
    note_unsaved(1);
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

// ---- What is on disk ----

bool Work::is_kept() const
{
    if (files_.journal.empty()) return unsaved_ == 0;
    if (!journal_) return true;
    try {
        journal_->flush();
        // If another process has claimed the journal, that process has kept this process's journal under another name.
        return journal_->is_in_place() || (hold_ && !hold_->is_kept() && !journal_->present_name().empty());
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

std::function<void()> Work::flusher() const
{
    if (!journal_) return {};
    return [journal = journal_] { journal->flush(); };
}

void Work::flush()
{
    if (!journal_) return;
    journal_->flush();
    if (!only_looks_) expect_hold();
}

Work::JournalState Work::journal() const
{
    if (!journal_) return {.bytes = is_to_set_aside_ ? 0 : scan_.file_bytes, .failure = {}};
    return {journal_->bytes(), journal_->failure()};
}

}  // namespace shvr
