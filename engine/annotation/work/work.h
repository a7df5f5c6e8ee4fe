#pragma once
// The user's work: the document, its history, the journal that keeps both, and the files it is saved to.
//
// The journal is the truth between sessions. Opening replays it from its last complete state, so the history continues
// where it ended, and unsaved work is there, too. Saved files (mask, trace, offsets) are for other programs; they are
// loaded only where there is no journal, or where another program has changed them since, and then the journal is set
// aside, not removed. The journal begins with the first command: only looking leaves no file.
//
// One thread, the main one. Only writing the journal happens elsewhere (journal.h).

#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>

#include "engine/annotation/trace/trace_file.h"
#include "engine/annotation/work/journal.h"
#include "engine/annotation/work/journal_record.h"
#include "engine/projects/import_volume.h"

namespace shvr {

struct WorkFiles {
    std::filesystem::path journal{};                   ///< empty: work is kept in memory only
    std::filesystem::path mask{}, trace{}, density{};  ///< empty: not saved
    std::string volume_hash{};                         ///< Session::volume_hash
    VolumeInfo volume{};                               ///< the annotated volume
    SettingValues settings{};                          ///< of the session, as it was read from its file
    /// Settings as this version writes them, so that files and journals of different versions can be compared. Fails
    /// where it cannot read them.
    std::function<SettingValues(const SettingValues&)> normalized{};
};

class Work {
public:
    /// An empty document, without files.
    Work(const Size3& size, VoxelType type);
    ~Work();
    Work(const Work&) = delete;  // its history holds a pointer to it

    enum class Start {
        as_left,  ///< with the contents of the journal or of the saved files
        fresh,    ///< empty; an existing journal is set aside at the first command
    };
    /// For a Work without commands. Returns messages for the user: unsaved work, a damaged end of the journal, files
    /// that other programs have changed. Fails, loading nothing, if a file is of another volume or malformed.
    std::vector<std::string> open(const WorkFiles& files, Start start = Start::as_left);

    const Document& document() const { return document_; }
    /// The session's lasting settings: the journal's or, where the session's file was changed since it was saved, the
    /// file's. The first command then records that change as a step of its own.
    SettingValues settings() const;
    const History& history() const { return history_; }

    /// As History's, but written to the journal first. Fail, with nothing done, if the journal cannot be started, is
    /// locked by another process, or does not accept the command.
    const Command* perform(Command command);
    void extend(std::vector<Change> changes);
    /// Sets the sections that differ, as one command; null where none does.
    const Command* change_settings(std::string label, const SettingValues& values);
    const Command* undo();
    const Command* redo();
    /// Not a step of the history. What is selected must exist.
    void select_trace(TraceSelection selection) { document_.trace.select(std::move(selection)); }

    /// Writes the files, each atomically, and records it in the journal; a label image gets the groups' `looks`. Trace
    /// and offsets are written only if they have changed. Fails if one cannot be written (a retry may succeed), or if
    /// there is something to save and no file named for it. Returns the files it wrote. `save_session` writes the
    /// session's file, which then holds `settings()`.
    std::vector<std::filesystem::path> save(std::vector<LabelImage::Color> looks = {},
                                            const std::function<void()>& save_session = {});
    void name_files(const std::filesystem::path& mask, const std::filesystem::path& trace,
                    const std::filesystem::path& density);
    /// Commands, undos and redos since the last save.
    size_t unsaved() const { return unsaved_; }
    /// No command since has changed the trace.
    bool trace_is_saved() const { return !touched_.trace; }
    /// Waits until the journal is on disk; fails with the reason if that is not possible.
    void flush();

    struct JournalState {
        uint64_t bytes = 0;
        std::string failure;  ///< why nothing can be written now; work waits in memory
    };
    JournalState journal() const;

    struct Limits {
        /// Of commands kept in memory; older ones are fetched from the journal.
        uint64_t history_bytes = uint64_t{256} << 20;
        /// After this much (or twice the last state's size), or this many steps, the journal gets a state: opening then
        /// takes as long as reading one, and states are at most half of a journal.
        uint64_t bytes_between_states = uint64_t{16} << 20;
        size_t steps_between_states = 20000;
    };
    void set_limits(const Limits& limits) { limits_ = limits; }

private:
    Document empty_document() const;
    void check_subject() const;
    /// Returns why it stopped early, and then drops the remaining records from the scan; empty if it took all.
    std::string replay();
    void replay_records();
    std::vector<std::byte> content_of(RecordNumber number) const;
    void begin_history();
    void load_files();
    SavedFiles digests() const;
    bool files_are_as_saved() const;
    std::optional<SavedFiles> last_saved() const;
    std::string compare_settings();
    void record_settings_from_outside();
    void begin_journal();
    void set_journal_aside();
    RecordNumber record(RecordKind kind, std::string label = {}, std::vector<std::byte> content = {});
    void touch(std::span<const Change> changes);
    const Command* go(const Command* (History::*way)(Document&), RecordKind kind);
    void note_step();
    void keep_state();

    Size3 size_;
    VoxelType type_;
    WorkFiles files_;
    Document document_;
    History history_;
    JournalScan scan_;                       ///< as it was read; the journal continues from it
    std::optional<FileDescriptor> scanned_;  ///< its file
    bool is_to_set_aside_ = false;           ///< the journal that was read does not belong to this work
    bool is_fresh_ = false;                  ///< ... because the caller asked for a fresh start
    std::map<std::filesystem::path, std::filesystem::file_time_type>
        loaded_;                                 ///< files, and when they were written as they were loaded
    std::vector<Change> settings_from_outside_;  ///< differences of the session's file, to be recorded
    std::unique_ptr<Journal> journal_;
    size_t unsaved_ = 0;
    struct Touched {
        bool trace = false, density = false;
    } touched_;  ///< since the last save
    uint64_t since_state_bytes_ = 0, state_bytes_ = 0;
    size_t since_state_steps_ = 0;
    std::future<std::vector<std::byte>> state_;  ///< being made of a copy of the document
    RecordNumber state_about_ = 0;
    Limits limits_;
};

}  // namespace shvr
