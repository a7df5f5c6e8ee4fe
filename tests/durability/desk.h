#pragma once
// A working folder, and random steps of work that two processes can reproduce identically.

#include <memory>
#include <random>

#include "engine/annotation/work/work.h"
#include "tests/support/random_annotation.h"

namespace shvr::test {

/// Messages from opening go to `said`.
inline std::unique_ptr<Work> open_work(const WorkFiles& files, std::string& said, const Work::Opening& opening = {})
{
    auto work = std::make_unique<Work>(ANNOTATED_SIZE, ANNOTATED_TYPE);
    // Small limits, so that states and reads from the journal are exercised.
    work->set_limits({.history_bytes = 20000, .bytes_between_states = 20000, .steps_between_states = 100});
    said.clear();
    for (const Notice& notice : work->open(files, opening)) said += notice.text + "\n";
    for (const Dispute& dispute : work->disputes()) said += dispute.text + "\n";
    return work;
}

/// Performs a command, undo, redo or revert, or keeps settings, which is no step. Returns whether it made a step. For
/// `Work` or a model of it.
template <class Model>
bool random_step_of(Model& model, const Document& document, std::mt19937& random)
{
    const auto choice = random() % 20;
    if (choice < 2) return model.undo();
    if (choice < 4) return model.redo();
    if (choice == 4) return model.revert();
    if (choice < 8) {
        model.keep_settings(random_kept(random));
        return false;
    }
    Command command = random_command(document, random);
    if (command.changes.empty()) return false;
    model.perform(std::move(command));
    return true;
}

inline bool random_step(Work& work, std::mt19937& random)
{
    struct Steps {
        bool undo() const { return work.undo() != nullptr; }
        bool redo() const { return work.redo() != nullptr; }
        bool revert() const
        {
            try {
                return work.revert() != nullptr;
            } catch (const Error&) {  // nothing was ever saved, or the disk refuses
                return false;
            }
        }
        void keep_settings(const SettingValues& values) const { work.keep_settings(values); }
        void perform(Command command) const { work.perform(std::move(command)); }
        Work& work;
    };
    Steps steps{work};
    return random_step_of(steps, work.document(), random);
}

/// Saves with an empty session.
inline Work::Saved save(Work& work)
{
    return work.save({}, [] {});
}

/// The number of steps in a journal.
inline size_t steps_in(const std::filesystem::path& journal)
{
    size_t steps = 0;
    for (const JournalRecord& record : scan_journal(journal).records)
        steps +=
            record.kind == RecordKind::command || record.kind == RecordKind::undo || record.kind == RecordKind::redo;
    return steps;
}

}  // namespace shvr::test
