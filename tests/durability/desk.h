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

/// A command, an undo or a redo; false if it did nothing. For `Work` or a model of it.
template <class Undo, class Redo, class Perform>
bool random_step(const Document& document, std::mt19937& random, const Undo& undo, const Redo& redo,
                 const Perform& perform)
{
    const auto choice = random() % 8;
    if (choice == 0) return undo();
    if (choice == 1) return redo();
    Command command = random_command(document, random);
    if (command.changes.empty()) return false;
    perform(std::move(command));
    return true;
}

inline bool random_step(Work& work, std::mt19937& random)
{
    return random_step(
        work.document(), random, [&] { return work.undo() != nullptr; }, [&] { return work.redo() != nullptr; },
        [&](Command command) { work.perform(std::move(command)); });
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
