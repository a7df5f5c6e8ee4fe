#include "engine/annotation/work/work.h"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <utility>

#include "engine/annotation/files/mask_export.h"
#include "engine/annotation/files/mask_image.h"
#include "engine/annotation/files/mask_import.h"
#include "engine/annotation/files/offset_import.h"
#include "engine/annotation/files/volume_place.h"
#include "engine/base/atomic_writer.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

bool is_step(RecordKind kind)
{
    return kind == RecordKind::command || kind == RecordKind::undo || kind == RecordKind::redo;
}

size_t steps_since_save(const JournalScan& scan)
{
    size_t steps = 0;
    for (const JournalRecord& record : scan.records) {
        if (record.kind == RecordKind::saved) steps = 0;
        if (is_step(record.kind)) ++steps;
    }
    return steps;
}

bool is_there(const fs::path& path)
{
    std::error_code ignored;
    return !path.empty() && fs::exists(path, ignored);
}

/// `path` with ".old" or, if that exists and must stay, with ".old2", ".old3" and so on.
fs::path old_of(const fs::path& path, bool replaces)
{
    fs::path old = path;
    old += ".old";
    for (int number = 2; !replaces && is_there(old); ++number) {
        old = path;
        old += sentence(".old", number);
    }
    return old;
}

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
    history_.fetch_from([this](RecordNumber number) { return changes_of(content_of(number)); });
}

std::vector<std::byte> Work::content_of(RecordNumber number) const
{
    if (journal_) return journal_->read(number);
    return shvr::content_of(scan_.records.at(number - 1), scanned_.value(), files_.journal);
}

// ---- Opening ----

std::vector<std::string> Work::open(const WorkFiles& files, Start start)
{
    SHVR_CHECK(!journal_ && history_.undoable() == 0, "work has begun");
    files_ = files;
    is_fresh_ = start == Start::fresh;
    scan_ = files.journal.empty() ? JournalScan{} : scan_journal(files.journal);
    if (scan_.inode != 0) {
        scanned_.emplace(::open(files.journal.c_str(), O_RDONLY | O_CLOEXEC));
        if (!*scanned_) fail(files.journal.string(), ": cannot be opened: ", reason_of(errno));
    }
    std::vector<std::string> messages;
    const std::string name = files.journal.string();
    is_to_set_aside_ = is_fresh_ && scan_.inode != 0;
    touched_.trace = touched_.density = is_fresh_;  // existing files belong to earlier work
    document_.settings = Settings(files.settings);
    if (is_fresh_) return messages;
    if (!scan_.records.empty()) {
        check_subject();
        is_to_set_aside_ = !files_are_as_saved();
    }
    if (is_to_set_aside_)
        messages.push_back(sentence(name,
                                    ": the saved files were changed since it was written; they are taken, and what "
                                    "the journal holds, with ",
                                    steps_since_save(scan_), " steps that were not saved, will be set aside"));
    if (is_to_set_aside_ || scan_.records.empty()) {
        load_files();
        return messages;
    }
    const std::string damage = replay();
    if (!damage.empty()) messages.push_back(sentence(name, ": ", damage, "; what comes before is taken"));
    if (scan_.end < scan_.file_bytes)
        messages.push_back(sentence(name, ": its last ", scan_.file_bytes - scan_.end,
                                    " bytes were not written to the end; the ", scan_.records.size(),
                                    " records before are taken"));
    if (std::string message = compare_settings(); !message.empty()) messages.push_back(std::move(message));
    unsaved_ = steps_since_save(scan_);
    touched_.trace = touched_.density = unsaved_ > 0;
    if (unsaved_ > 0)
        messages.push_back(sentence(name, ": holds ", unsaved_, unsaved_ == 1 ? " step that was" : " steps that were",
                                    " not saved; nothing is lost"));
    return messages;
}

void Work::check_subject() const
{
    const std::string name = files_.journal.string();
    JournalSubject found;
    try {
        found = subject_of(content_of(1));
    } catch (const Error& error) {
        fail(name, ": does not say which volume it is of: ", error.what());
    }
    const auto in_words = [](const Size3& size, VoxelType type) {
        return sentence(size.x, "x", size.y, "x", size.z, " voxels of ", name_of(type));
    };
    if (found.size != size_ || found.type != type_)
        fail(name, ": is of a volume of ", in_words(found.size, found.type), "; expected ", in_words(size_, type_));
    if (!found.image.empty() && !files_.volume_hash.empty() && found.image != files_.volume_hash)
        fail(name, ": is of an image with the hash ", found.image, "; expected ", files_.volume_hash);
}

/// What the journal says of the files when they were last written; nothing if that is not known: an interrupted save
/// may have left old files or new ones.
std::optional<SavedFiles> Work::last_saved() const
{
    for (RecordNumber number = scan_.records.size(); number > 0; --number) {
        const RecordKind kind = scan_.records[number - 1].kind;
        if (kind == RecordKind::saving) return {};
        if (kind != RecordKind::saved) continue;
        try {
            return saved_files_of(content_of(number));
        } catch (const Error&) {
            return {};  // damage, which replaying reports
        }
    }
    return {};
}

bool Work::files_are_as_saved() const
{
    const std::optional<SavedFiles> saved = last_saved();
    if (!saved) return true;
    SavedFiles now = digests();
    now.settings = saved->settings;
    return *saved == now;
}

/// Decides for each setting whether the journal or the session's file is believed. Returns a message for the user.
std::string Work::compare_settings()
{
    SettingValues known = document_.settings.values(), saved = files_.settings;
    const std::optional<SavedFiles> last = last_saved();
    if (last && last->settings) saved = *last->settings;
    if (files_.normalized) {
        try {
            known = files_.normalized(known);
            saved = files_.normalized(saved);
        } catch (const Error& error) {
            document_.settings = Settings(files_.settings);
            return sentence(files_.journal.string(), ": its settings cannot be read: ", error.what(),
                            "; those of the session's file are taken");
        }
    }
    std::string changed;
    for (const auto& [name, value] : files_.settings) {
        const auto in_journal = known.find(name);
        if (in_journal == known.end()) {
            known[name] = value;
        } else if (value != in_journal->second && saved.contains(name) && value != saved[name]) {
            settings_from_outside_.emplace_back(SettingChange{name, in_journal->second, value});
            changed += (changed.empty() ? "" : ", ") + name;
        }
    }
    document_.settings = Settings(std::move(known));
    if (changed.empty()) return {};
    return sentence(files_.journal.string(),
                    ": these settings of the session were changed since it was saved: ", changed,
                    "; they are taken, and can be undone after the next step");
}

SettingValues Work::settings() const
{
    Settings settings = document_.settings;
    for (const Change& change : settings_from_outside_)
        settings.apply(std::get<SettingChange>(change), Direction::forwards);
    return settings.values();
}

SavedFiles Work::digests() const
{
    return {file_digest(files_.mask), file_digest(files_.trace), file_digest(files_.density),
            document_.settings.values()};
}

void Work::load_files()
{
    if (is_there(files_.mask) || is_in_archive(files_.mask)) {
        // A mask of another size is also of another image, and the size makes the better message.
        const std::vector<MaskBrickChange> changes = import_mask(files_.mask, space_of(files_.volume));
        check_mask_image(files_.mask, files_.volume_hash);
        for (const MaskBrickChange& change : changes) document_.mask.apply(change, Direction::forwards);
    }
    if (is_there(files_.trace)) document_.trace = load_trace(files_.trace, space_of(files_.volume)).trace;
    if (is_there(files_.density)) document_.density = import_offsets(files_.density, space_of(files_.volume), type_);
    for (const fs::path& path : {files_.mask, files_.trace, files_.density})
        if (is_there(path)) loaded_[path] = fs::last_write_time(path);
}

std::string Work::replay()
{
    std::string damage;
    for (;;) {
        try {
            replay_records();
            return damage;
        } catch (const Error& error) {
            damage = error.what();
        }
    }
}

void Work::replay_records()
{
    document_ = empty_document();
    begin_history();
    RecordNumber at = scan_.records.size();
    while (at > 0 && scan_.records[at - 1].kind != RecordKind::state) --at;
    const RecordNumber state = at;
    const auto replay_one = [&](RecordNumber known) {
        const JournalRecord& record = scan_.records[at - 1];
        const bool is_noted = at <= known;
        const auto apply = [&] {
            if (!is_noted) apply_if_it_fits(document_, changes_of(content_of(at)), Direction::forwards);
        };
        switch (record.kind) {
            case RecordKind::command:
                apply();
                history_.note(record.label, at);
                break;
            case RecordKind::extension:
                apply();
                history_.note_extension(at);
                break;
            case RecordKind::undo:
                if (is_noted)
                    history_.note_undo();
                else if (!history_.undo(document_))
                    fail("more is undone than was done");
                break;
            case RecordKind::redo:
                if (is_noted)
                    history_.note_redo();
                else if (!history_.redo(document_))
                    fail("more is done again than was undone");
                break;
            default: break;  // states, saves, and kinds unknown to this version
        }
    };
    try {
        RecordNumber known = 0;
        if (state > 0) {
            known = scan_.records[state - 1].about;
            if (known >= state) fail("a state is of record ", known, " behind it");
            document_ = document_of(content_of(state), empty_document());
        }
        for (at = 1; at <= scan_.records.size(); ++at) replay_one(known);
    } catch (const Error& error) {
        const RecordNumber damaged = at;
        scan_.cut(damaged - 1);
        fail("record ", damaged, " cannot be taken: ", error.what());
    }
}

// ---- Working ----

void Work::begin_journal()
{
    if (journal_ || files_.journal.empty()) return;
    for (const auto& [path, time] : loaded_)
        if (!is_there(path) || fs::last_write_time(path) != time)
            fail(path.string(),
                 ": was changed by another program since it was opened; expected it as it was: open it again");
    if (is_to_set_aside_) set_journal_aside();
    const bool is_new = scan_.records.empty();
    journal_ = std::make_unique<Journal>(files_.journal, scan_);
    scanned_.reset();
    if (!is_new) return record_settings_from_outside();
    journal_->append(RecordKind::subject, {}, bytes_of(JournalSubject{size_, type_, files_.volume_hash}));
    // Makes the journal readable without the files.
    std::vector<std::byte> state = bytes_of(document_);
    state_bytes_ = state.size();
    journal_->append(RecordKind::state, {}, std::move(state), 1);
    journal_->append(RecordKind::saved, {}, bytes_of(digests()));
}

/// A change of the session's file by another program is a step like any other, so it can be undone, too.
void Work::record_settings_from_outside()
{
    if (settings_from_outside_.empty()) return;
    Command command{"settings changed in the session's file", std::exchange(settings_from_outside_, {})};
    const RecordNumber number = record(RecordKind::command, command.label, bytes_of(command.changes));
    history_.perform(document_, std::move(command), number);
    ++unsaved_;
}

void Work::set_journal_aside()
{
    {
        // Never while another process writes it.
        const Journal nobody_else(files_.journal, scan_);
    }
    scanned_.reset();
    const fs::path old = old_of(files_.journal, is_fresh_ || steps_since_save(scan_) == 0);
    if (std::rename(files_.journal.c_str(), old.c_str()) != 0)
        fail(old.string(), ": cannot be written: ", reason_of(errno));
    sync_folder(old);
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

void Work::touch(std::span<const Change> changes)
{
    const ByKind touch{
        [](const MaskBrickChange&) {},  // every save writes the mask
        [&](const TraceChange&) { touched_.trace = true; },
        [&](const DensityBrickChange&) { touched_.density = true; },
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

const Command* Work::change_settings(std::string label, const SettingValues& values)
{
    Command command{std::move(label), {}};
    const SettingValues now = settings();
    for (const auto& [name, value] : values) {
        const auto found = now.find(name);
        const std::string before = found == now.end() ? std::string() : found->second;
        if (before != value) command.changes.emplace_back(SettingChange{name, before, value});
    }
    return perform(std::move(command));
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
    files_.mask = mask;
    files_.trace = trace;
    files_.density = density;
}

std::vector<fs::path> Work::save(std::vector<LabelImage::Color> looks, const std::function<void()>& save_session)
{
    const bool has_mask = !document_.mask.painted_bricks().empty();
    const bool has_trace = !document_.trace.nodes().empty(), has_offsets = document_.density.voxels() > 0;
    if (files_.mask.empty() && (files_.trace.empty() || has_mask))
        fail("the session names no mask to save to; expected the key annotation.mask");
    if (files_.trace.empty() && has_trace)
        fail("the session names no file for the trace; expected the key annotation.trace");
    if (files_.density.empty() && has_offsets)
        fail("the session names no file for density offsets; expected the key annotation.density");
    if (scan_.inode != 0 || history_.undoable() + history_.redoable() > 0) begin_journal();
    if (journal_) {
        journal_->append(RecordKind::saving, {}, {});
        journal_->flush();
    }
    std::vector<fs::path> written;
    if (!files_.mask.empty()) {
        save_mask_as(files_.mask, document_.mask, files_.volume,
                     {.colors = std::move(looks), .painted_on = files_.volume_hash});
        save_mask_image(files_.mask, files_.volume_hash);
        written.push_back(files_.mask);
    }
    // A trace that has become empty is saved as empty; if there never was one, no file is written.
    const auto is_to_write = [](bool is_touched, bool has_any, const fs::path& path) {
        return is_there(path) ? is_touched : has_any;
    };
    if (is_to_write(touched_.trace, has_trace, files_.trace)) {
        save_trace(files_.trace, document_.trace, space_of(files_.volume));
        written.push_back(files_.trace);
    }
    if (is_to_write(touched_.density, has_offsets, files_.density)) {
        save_offsets_as(files_.density, document_.density, files_.volume);
        written.push_back(files_.density);
    }
    if (save_session) save_session();
    loaded_.clear();
    if (journal_) {
        journal_->append(RecordKind::saved, {}, bytes_of(digests()));
        journal_->flush();
    }
    unsaved_ = 0;
    touched_ = {};
    return written;
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
