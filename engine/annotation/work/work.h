#pragma once
// The user's work: the document, its history, the journal that stores both, and the files to which they are saved.
//
// The journal is authoritative between sessions. Opening replays it from its last complete state, so the history
// continues where it ended, including unsaved work. Saved files (mask, trace, offsets) are for other programs. They are
// loaded if there is no journal. A missing file is restored from the journal; for a file that another program has
// changed, the user must decide. No file is overwritten unless the journal holds its content (README.md has the table).
// The first command creates the journal, so looking at work leaves no file behind.
//
// Used by one thread at a time: the thread that opens the work, then the main thread. Other threads write the journal
// (journal.h) and saves (Work::Saving).

#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>

#include "engine/annotation/work/journal.h"
#include "engine/annotation/work/saved_files.h"
#include "engine/annotation/writers/hold.h"
#include "engine/base/progress.h"
#include "engine/projects/import_volume.h"

namespace shvr {

/// A message for the user.
struct Notice {
    std::string text;
    bool is_loss = false;  ///< something was lost; to be shown even by callers that suppress messages
};

/// Which version to use if another program has changed a saved file.
enum class Belief {
    ask,      ///< the user decides about `Work::disputes`; until `choose` is called, the journal is shown read-only
    journal,  ///< the journal's version; the next save keeps the file under another name
    files,    ///< the files' version; the differences become a command, which can be undone
};

/// A saved file that another program has changed since the journal last recorded it.
struct Dispute {
    Part part = Part::mask;
    std::filesystem::path file;
    std::string text;                 ///< the file, its state as found, and the expected state
    std::vector<Change> differences;  ///< changes from the journal's content to the file's content
};

/// Thrown while saved files were changed by other programs and the user has not decided which version to use.
class Disputed : public Error {
public:
    using Error::Error;
};

class Work {
public:
    /// An empty document, without files.
    Work(const Size3& size, VoxelType type);
    ~Work();
    Work(const Work&) = delete;  // its history holds a pointer to it

    enum class Start {
        as_left,  ///< starts with the contents of the journal or, without one, of the saved files
        fresh,    ///< starts empty; the first command sets an existing journal aside
    };
    struct Opening {
        Start start = Start::as_left;
        Belief belief = Belief::ask;
        bool only_look = false;       ///< read-only: takes no hold, and accepts no command
        std::string why_only_look{};  ///< told to who tries to change the work; empty: a sentence about the journal
        /// States that the work will be changed at once: if others may still write the journal, opening takes it from
        /// them, rather than the first command. The journal is read again if they write to it meanwhile.
        bool takes_over = false;
        std::shared_ptr<Hold> hold{};  ///< a hold of this journal to use; null: opening takes the hold
        std::string program = "shvr";  ///< as in Holder; describes a hold that opening takes
        Progress progress{};           ///< reports the replay of the journal; an exception from it cancels the opening
    };
    /// Call this on a Work without commands. Returns messages about unsaved work, missing or unreadable files, and a
    /// missing or damaged journal. Fails, without loading anything, if a file belongs to another volume or is malformed
    /// and no journal holds its content. Fails with JournalTaken if another process is writing the journal.
    std::vector<Notice> open(const WorkFiles& files, const Opening& opening);
    std::vector<Notice> open(const WorkFiles& files) { return open(files, Opening{}); }

    /// Decisions to be made; empty: none.
    const std::vector<Dispute>& disputes() const { return disputes_; }
    /// `choose` resolves all disputes, in favour of the files (applying their differences as one command) or of the
    /// journal as it is. Returns messages about the choice, and the command, which is valid until the history changes.
    struct Choice {
        std::vector<Notice> notices;
        const Command* command = nullptr;
    };
    Choice choose(Belief belief);
    /// Fails with Disputed if any dispute is unresolved.
    void expect_choice() const;

    /// True if commands and saves are refused.
    bool only_looks() const { return only_looks_; }
    /// Fails with JournalTaken, which states why, if commands are refused.
    void refuse_if_only_looking() const;
    /// Returns whether another process has claimed the journal since the last call, as noticed at the last write to the
    /// journal. After a claim this work is read-only; `claimed` states the reason and where its journal is kept.
    bool look_for_claim();
    const std::string& claimed() const { return claimed_; }
    const std::string& claimed_by() const { return claimed_by_; }  ///< as in `in_words`; empty: no process
    /// Null if there is none.
    std::shared_ptr<Hold> hold() const { return hold_; }

    const Document& document() const { return document_; }
    /// The session's lasting settings: the journal's or, if the session's file was changed after it was saved, the
    /// file's. In the latter case the first command also records the change of the file, as a separate step.
    SettingValues settings() const;
    /// The last kept settings: these are restored on opening, but are not part of the work.
    const SettingValues& kept_settings() const { return kept_; }
    const History& history() const { return history_; }
    /// The time at which a step of the history began, in milliseconds since 1970 (UTC), to a tenth of a second; null
    /// without a journal and in journals of older programs.
    std::optional<int64_t> time_of(size_t step) const;
    /// Replaces the clock that gives the times noted in the journal, for annotators with simulated time.
    void set_clock(std::function<int64_t()> now_ms) { now_ms_ = std::move(now_ms); }

    /// Like the functions of History, but write to the journal first. They fail, without any effect, if the journal
    /// cannot be started, is locked by another process, or does not accept the command.
    const Command* perform(Command command);
    void extend(std::vector<Change> changes);
    /// Sets the sections whose values differ from the present ones, as one command; returns null if none differ.
    const Command* change_settings(std::string label, const SettingValues& values);
    const Command* undo();
    const Command* redo();
    /// Reverts to the last saved state, or to the last state taken from a saved file, as one command; returns null if
    /// nothing differs. Reads the state from the journal, so later changes of the files have no effect. Fails, without
    /// any change, if nothing was ever saved or the journal cannot be read.
    const Command* revert();
    /// Keeps the sections whose values differ from those kept before. This is not a command and does not make a save
    /// necessary. The sections are written to the journal if the first command has started it; otherwise, or if the
    /// journal cannot be written, they stay in memory and are written with the next record. Never fails. Do not pass
    /// sections that were set for this run only ("key=value").
    void keep_settings(const SettingValues& values);
    /// Selects objects, which must exist. The selection is not a step of the history.
    void select_trace(TraceSelection selection) { document_.trace.select(std::move(selection)); }

    /// `save` writes the files, each atomically, and records the save in the journal. `looks`: the groups' colours and
    /// names for a label image. Trace and offsets are written only if they have changed or are missing. A file with
    /// content that the journal lacks is renamed first and kept. Fails if a file cannot be written (a retry may
    /// succeed), or if a part has content but no file name. `save_session` writes the session's file, which then holds
    /// `settings()` and `kept_settings()`.
    struct Saved {
        std::vector<std::filesystem::path> files;
        std::vector<Notice> notices;
    };
    Saved save(std::vector<LabelImage::Color> looks = {}, const std::function<void()>& save_session = {});

    /// A save in the background: writes the state at the start of the save. Later commands are not included and stay
    /// unsaved. The journal does not record the save before `write` has completed.
    class Saving;
    /// Copies the state to be written, at the cost of a copy of the document. Fails for the same reasons as `save`
    /// before it writes. Only one save can be in progress; call `end_save` before the next one.
    std::unique_ptr<Saving> begin_save(std::vector<LabelImage::Color> looks);
    /// Ends a save. Call this after every begin_save, even if the files were not written.
    Saved end_save(Saving& saving);
    bool is_saving() const { return is_saving_; }

    /// Continues the work, with its whole history, under other names, none of which may exist yet. The files under the
    /// old names stay as they are and are released. Writes, each on disk before the next: a copy of the journal, the
    /// mark that a save begins, the files, their digests, and `session`, by `save_session`. A crash before the session
    /// is written leaves files that nothing refers to; a later crash leaves a complete project. On failure nothing has
    /// changed, and new files are removed. If there is no history yet, the first command creates the new journal.
    Saved save_as(const WorkFiles& to, std::vector<LabelImage::Color> looks, const std::filesystem::path& session = {},
                  const std::function<void()>& save_session = {});
    /// save_as() in the background, like `begin_save`. Until `end_save_as`, commands are refused, because only one of
    /// the two journals would contain them.
    class SavingAs;
    std::unique_ptr<SavingAs> begin_save_as(const WorkFiles& to, std::vector<LabelImage::Color> looks,
                                            const std::filesystem::path& session = {});
    Saved end_save_as(SavingAs& saving);
    bool is_saving_as() const { return is_saving_as_; }
    /// A function that writes the present document to other files, which must not exist yet. It may be called on any
    /// thread, even after the work has ended.
    std::function<void(const WorkFiles& to)> copier(std::vector<LabelImage::Color> looks) const;
    void name_files(const std::filesystem::path& mask, const std::filesystem::path& trace,
                    const std::filesystem::path& density);
    /// The mask whose header an export keeps (mask_segments.h).
    const std::filesystem::path& mask_of_header() const { return shvr::mask_of_header(files_); }
    /// Makes the next save keep the header of a mask that was taken into this work.
    void keep_header_of(const std::filesystem::path& mask) { files_.mask_before = mask; }
    /// Number of commands, undos and redos since the last save.
    size_t unsaved() const { return unsaved_; }
    /// Whether nothing needs saving: all commands are saved, and no file is missing or unreadable.
    bool is_saved() const { return unsaved_ == 0 && !misses_files_; }
    /// Whether the journal on disk holds all commands, so that closing without a save does not lose any.
    bool is_kept() const;
    /// Completes background tasks, after which another Work can open the same files even before this one is destroyed.
    void settle();
    /// A function that waits until the journal is on disk; for any thread, may outlive the work. Empty: no journal.
    std::function<void()> flusher() const;
    /// Returns whether the trace is unchanged since the last save.
    bool trace_is_saved() const { return !touched_[size_t(Part::trace)]; }
    /// Waits until the journal is on disk; fails with the reason if that is not possible.
    void flush();

    struct JournalState {
        uint64_t bytes = 0;
        std::string failure;  ///< why writing fails now; meanwhile, work stays in memory
    };
    JournalState journal() const;

    struct Limits {
        /// Memory budget of commands; older commands are dropped, and fetched from the journal again when needed.
        uint64_t history_bytes = uint64_t{256} << 20;
        /// A state is written to the journal after this many bytes (or twice the last state's size), or this many
        /// steps. So opening takes about as long as reading one state, and states make up at most half of a journal.
        uint64_t bytes_between_states = uint64_t{16} << 20;
        size_t steps_between_states = 20000;
    };
    void set_limits(const Limits& limits) { limits_ = limits; }

private:
    Document empty_document() const;

    // Other writers
    void note_claim();
    void expect_hold();
    void tell_doubtful(std::vector<Notice>& notices) const;
    std::shared_ptr<Journal> journal_left_to_others();
    void take_over(std::vector<Notice>& notices);
    void keep_journal_in_place();
    void set_journal_aside();

    // Opening
    void name_mask(const std::filesystem::path& stated);
    void tell_mask_to_read(std::vector<Notice>& notices) const;
    std::vector<Notice> read();
    std::vector<Notice> open_once();
    void read_journal();
    void open_fresh();
    std::vector<Notice> open_from_files(const std::string& damage);
    void check_subject() const;
    /// Replays the journal. If it must stop early, returns the reason and drops the remaining records; otherwise empty.
    std::string replay();
    struct Replayed {
        Document document;
        History history;
    };
    Replayed replayed(const JournalScan& scan, RecordNumber last, RecordNumber& at) const;
    std::vector<std::byte> content_of(RecordNumber number) const;
    /// The changes of a record, converted to the volume's present spacing.
    std::vector<Change> changes_at(RecordNumber number) const;
    void bring_to_spacing(Change& change, RecordNumber number) const;
    void read_spaces(RecordNumber& at);
    void tell_spacing(std::vector<Notice>& notices);
    void fetch_from_journal(History& history) const;
    void begin_history();
    void look_at_files(std::vector<Notice>& notices);
    void look_at_file(Part part, std::vector<Notice>& notices);
    void look_at_mask_image(std::vector<Notice>& notices) const;
    std::vector<Document> documents_at_saves() const;
    bool is_as_written(Part part, const Document& found) const;
    std::string what_happened_to(Part part) const;
    bool lacks_record_of_mask() const;
    void compare_settings(std::vector<Notice>& notices);
    void record_settings_from_outside();
    void compare_kept_settings(std::vector<Notice>& notices);
    SettingValues kept_at(RecordNumber number) const;

    // Working
    void begin_journal();
    void open_journal();
    void begin_records();
    void continue_records();
    RecordNumber record(RecordKind kind, std::string label = {}, std::vector<std::byte> content = {});
    void record_files(RecordKind kind, std::string label = {});
    void note_time();
    void append_kept(const SettingValues& values, RecordNumber about);
    void write_kept();
    void touch(std::span<const Change> changes);
    const Command* go(const Command* (History::*way)(Document&), RecordKind kind);
    /// 0: the last step continues.
    void note_unsaved(size_t steps);
    void note_step();
    void keep_state();

    // Saving
    /// The record of the last save of each part; 0: it was never saved.
    struct LastSave {
        std::array<RecordNumber, 3> of{};
    };
    LastSave last_save(const JournalScan& scan) const;
    static RecordNumber begin_of_save(const JournalScan& scan, RecordNumber saved);
    std::vector<Change> settings_since_save(const Document& saved) const;
    void expect_names(const WorkFiles& files) const;
    static void write(Part part, const Document& document, const WorkFiles& files,
                      const std::vector<LabelImage::Color>& looks, const Journal* journal,
                      const Progress& progress = {});
    void note_file(Part part);

    Size3 size_;
    VoxelType type_;
    WorkFiles files_;
    Document document_;
    History history_;
    JournalScan scan_;                       ///< the journal as read from its file; new records continue it
    std::optional<FileDescriptor> scanned_;  ///< its file
    bool is_to_set_aside_ = false;           ///< the journal that was read belongs to other work
    bool only_looks_ = false;
    std::string why_only_looks_;
    bool takes_files_ = false;  ///< the saved files are used, because the journal cannot be read
    bool is_fresh_ = false;     ///< started empty next to files of earlier work
    std::string program_;       ///< as in Holder
    std::string claimed_, claimed_by_;
    std::shared_ptr<Hold> hold_;
    std::vector<Dispute> disputes_;
    std::vector<Change> settings_from_outside_;  ///< changes of the session's file, to be recorded
    SettingValues kept_;                         ///< the present values
    SettingValues journaled_kept_;               ///< the kept settings in the journal
    RecordNumber last_kept_ = 0;                 ///< number of the journal's last `kept` record
    RecordNumber known_kept_ = 0;     ///< number of the last `kept` record that the session's file has; 0: unknown
    size_t kept_since_whole_ = 0;     ///< number of `kept` records since the last one that has all sections
    bool keeps_settings_ = false;     ///< the caller keeps some settings
    bool kept_from_outside_ = false;  ///< the state of the session's file must still be recorded
    bool cannot_keep_ = false;        ///< opening the journal failed; the first command reports why
    /// The space of the positions in records from `since` on; the first entry also applies to all earlier records.
    struct SpaceSince {
        RecordNumber since = 0;
        JournalSpace space;
    };
    std::vector<SpaceSince> spaces_;           ///< up to the volume's own space
    std::optional<RecordKind> space_to_note_;  ///< kind of the record that is to state the volume's own spacing
    SavedFiles known_;                         ///< state of the files as the journal last recorded it
    /// The state of a file as this process last saw it.
    struct Seen {
        std::optional<uint64_t> digest{};
        std::optional<FileStamp> stamp{};
        bool is_foreign = false;  ///< the journal does not hold the file's content
    };
    static Seen seen_at(const std::filesystem::path& file);
    static void note_file(const std::filesystem::path& file, Seen& seen);
    std::array<Seen, 3> seen_;
    std::shared_ptr<Journal> journal_;  ///< shared with a save in progress
    size_t unsaved_ = 0;
    bool misses_files_ = false;      ///< files that the journal lists are missing; the next save writes them
    std::array<bool, 3> touched_{};  ///< since the last save
    bool is_saving_ = false;
    bool is_saving_as_ = false;  ///< `is_saving_` is then true, too
    size_t unsaved_since_saving_ = 0;
    std::array<bool, 3> touched_since_saving_{};
    Progress opening_progress_;        ///< null except while opening
    std::function<int64_t()> now_ms_;  ///< null: the time of day
    /// A record of kind `time` that this process appended.
    struct TimeSince {
        RecordNumber since = 0;
        int64_t time_ms = 0;
    };
    std::vector<TimeSince> times_;
    uint64_t since_state_bytes_ = 0, state_bytes_ = 0;
    size_t since_state_steps_ = 0;
    std::future<std::vector<std::byte>> state_;  ///< result of encoding a copy of the document as a state
    RecordNumber state_about_ = 0;
    Limits limits_;
};

class Work::Saving {
public:
    Saving(const Saving&) = delete;
    /// Writes the files and their digests, as `Work::save` does, on any thread. Call this only once. An exception from
    /// `progress` cancels the save; as after a failure, some files may then be new and the others old. `save_names` is
    /// used if no session is saved: it writes the new names of files, but no settings, to the session's file.
    void write(const std::function<void()>& save_session = {}, const Progress& progress = {},
               const std::function<void()>& save_names = {});

private:
    friend class Work;
    Saving() = default;
    bool is_to_write(Part part) const;
    bool is_foreign(Part part) const;
    void write(Part part, const Progress& progress);

    WorkFiles files_;
    std::filesystem::path mask_before_;  ///< when the save began
    Document document_{.mask = Mask(Size3(0)), .trace = {}};
    std::vector<LabelImage::Color> looks_;
    std::shared_ptr<Journal> journal_;
    std::shared_ptr<const Hold> hold_;
    std::array<bool, 3> touched_{};
    std::array<Seen, 3> seen_;
    SavedFiles known_;
    SettingValues kept_;
    RecordNumber last_kept_ = 0, known_kept_ = 0;
    Saved saved_;
    bool has_session_ = false, is_written_ = false;
};

class Work::SavingAs {
public:
    SavingAs(const SavingAs&) = delete;
    /// Like Saving::write, but removes the new files if the save fails or is cancelled.
    void write(const std::function<void()>& save_session = {}, const Progress& progress = {});

private:
    friend class Work;
    SavingAs() = default;

    WorkFiles files_;
    Document document_{.mask = Mask(Size3(0)), .trace = {}};
    std::vector<LabelImage::Color> looks_;
    std::filesystem::path session_;
    std::string program_;
    std::shared_ptr<Journal> before_;  ///< the journal under the work's old name; null if there is no history yet
    SettingValues kept_;
    RecordNumber last_kept_ = 0, known_kept_ = 0;

    // The new files
    std::shared_ptr<Hold> hold_;
    std::unique_ptr<Journal> journal_;
    std::array<Seen, 3> seen_;
    SavedFiles known_;
    Saved saved_;
    bool has_session_ = false, is_written_ = false;
};

/// Returns a notice if the mask names a journal that is missing; null if the journal is there or none is named.
std::optional<Notice> note_missing_journal(const WorkFiles& files);

}  // namespace shvr
