// Reverts to the last saved state.

#include <utility>

#include "engine/annotation/work/work.h"

namespace shvr {

/// The last save of each part. Taking a part from a file that another program changed counts as a save, too.
Work::LastSave Work::last_save(const JournalScan& scan) const
{
    LastSave last;
    bool has_saved = false;
    SavedFiles before;
    for (RecordNumber number = 1; number <= scan.records.size(); ++number) {
        const JournalRecord& record = scan.records[number - 1];
        has_saved = has_saved || record.kind == RecordKind::saving;
        if (record.kind != RecordKind::saved && record.kind != RecordKind::known) continue;
        SavedFiles files;
        try {
            files = saved_files_of(content_of(number));
        } catch (const Error&) {
            continue;  // no information
        }
        // The journal's first record of files lists files that existed when it began. AFRESH: they are of earlier work.
        const bool is_of_files = record.label != AFRESH && (files.mask || files.trace || files.density);
        for (const Part part : PARTS) {
            RecordNumber& of = last.of[size_t(part)];
            if (record.kind == RecordKind::known ? digest_of(files, part) != digest_of(before, part)
                                                 : has_saved || is_of_files)
                of = record.kind == RecordKind::known ? number : begin_of_save(scan, number);
        }
        before = std::move(files);
    }
    return last;
}

/// The changes from the present settings to those in the session's file or, if these are unknown, to those of `saved`.
std::vector<Change> Work::settings_since_save(const Document& saved) const
{
    SettingValues then = known_.settings.value_or(saved.settings.values());
    if (files_.normalized) then = files_.normalized(then);
    const SettingValues& now = document_.settings.values();
    std::vector<Change> changes;
    for (const auto& [name, value] : now) {
        const auto found = then.find(name);
        const std::string after = found == then.end() ? std::string() : found->second;
        if (after != value) changes.emplace_back(SettingChange{name, value, after});
    }
    for (const auto& [name, value] : then)
        if (!now.contains(name)) changes.emplace_back(SettingChange{name, {}, value});
    return changes;
}

const Command* Work::revert()
{
    refuse_if_only_looking();
    expect_choice();
    if (journal_ || !settings_from_outside_.empty()) begin_journal();
    if (journal_) journal_->flush();
    const bool has_history = journal_ || (!scan_.records.empty() && !is_to_set_aside_);
    if (!has_history && history_.undoable() + history_.redoable() == 0) return nullptr;
    const std::string name = files_.journal.empty() ? "the work" : files_.journal.string();
    const JournalScan scan = journal_ ? scan_journal(files_.journal) : scan_;
    const LastSave last = has_history ? last_save(scan) : LastSave{};
    std::map<RecordNumber, Document> documents;
    for (const RecordNumber number : last.of) {
        if (number == 0 || documents.contains(number)) continue;
        RecordNumber at = 0;
        try {
            documents.emplace(number, replayed(scan, number, at).document);
        } catch (const Error& error) {
            fail(name, ": record ", at, " cannot be taken: ", error.what(),
                 "; expected the work as it was saved, to go back to it");
        }
    }
    if (documents.empty()) fail(name, ": was never saved; expected a save to go back to; undo takes back single steps");
    Command command{"reverted to the last save", {}};
    for (const Part part : PARTS) {
        const RecordNumber number = last.of[size_t(part)];
        if (number == 0) continue;
        for (Change& change : changes_between(part, document_, documents.at(number)))
            command.changes.push_back(std::move(change));
    }
    for (Change& change : settings_since_save(documents.rbegin()->second)) command.changes.push_back(std::move(change));
    return perform(std::move(command));
}

}  // namespace shvr
