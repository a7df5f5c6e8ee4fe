// Undoable settings: the choice between the values of the journal and of the session's file at opening, and the records
// of changes. The same for kept settings, which are restored on opening but are not steps of the history.

#include <utility>

#include "engine/annotation/work/work.h"

namespace shvr {

/// Decides for each setting whether to use the journal's value or that of the session's file.
void Work::compare_settings(std::vector<Notice>& notices)
{
    const std::string name_of_journal = files_.journal.string();
    SettingValues in_journal = document_.settings.values();
    SettingValues saved = known_.settings.value_or(files_.settings);
    if (files_.normalized) {
        try {
            in_journal = files_.normalized(in_journal);
            saved = files_.normalized(saved);
        } catch (const Error& error) {
            document_.settings = Settings(files_.settings);
            notices.push_back({sentence(name_of_journal, ": its settings cannot be read: ", error.what(),
                                        "; those of the session's file are taken"),
                               true});
            return;
        }
    }
    std::string changed;
    for (const auto& [name, value] : files_.settings) {
        const auto found = in_journal.find(name);
        if (found == in_journal.end()) {
            in_journal[name] = value;
        } else if (value != found->second && saved.contains(name) && value != saved[name]) {
            settings_from_outside_.emplace_back(SettingChange{name, found->second, value});
            changed += (changed.empty() ? "" : ", ") + name;
        }
    }
    document_.settings = Settings(std::move(in_journal));
    if (!changed.empty())
        notices.push_back(
            {sentence(name_of_journal, ": these settings of the session were changed since it was saved: ", changed,
                      "; they are taken, and can be undone after the next step")});
}

SettingValues Work::settings() const
{
    Settings settings = document_.settings;
    for (const Change& change : settings_from_outside_)
        settings.apply(std::get<SettingChange>(change), Direction::forwards);
    return settings.values();
}

/// Records a change that another program made to the session's file as an ordinary step, so that it can be undone.
void Work::record_settings_from_outside()
{
    if (settings_from_outside_.empty()) return;
    Command command{"settings changed in the session's file", std::exchange(settings_from_outside_, {})};
    const RecordNumber number = record(RecordKind::command, command.label, bytes_of(command.changes));
    history_.perform(document_, std::move(command), number);
    note_unsaved(1);
    // Otherwise the next comparison would find the same difference in the session's file again.
    if (!known_.settings) known_.settings.emplace();
    for (const auto& [name, value] : files_.settings) (*known_.settings)[name] = value;
    record_files(RecordKind::known);
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

// ---- Kept settings --------------------------------------------------------------------------------------------------

namespace {

/// After this many records of differences, all sections are recorded, so that opening must read only few records.
constexpr size_t MAX_DIFFERENCES = 256;

SettingValues normalized_by(const std::function<SettingValues(const SettingValues&)>& normalized,
                            const SettingValues& values)
{
    return normalized ? normalized(values) : values;
}

}  // namespace

/// Kept settings as of a `kept` record. Each such record names the previous one, back to a record with all sections.
SettingValues Work::kept_at(RecordNumber number) const
{
    SettingValues values;
    while (number != 0) {
        if (number > scan_.records.size() || scan_.records[number - 1].kind != RecordKind::kept)
            fail("record ", number, " holds no kept settings");
        for (auto& [name, value] : setting_values_of(content_of(number)))
            values.try_emplace(name, std::move(value));  // newest first: existing values stay
        const RecordNumber before = scan_.records[number - 1].about;
        if (before >= number) fail("record ", number, " continues record ", before, " behind it");
        number = before;
    }
    return values;
}

/// Decides for each section whether to use the journal's value or that of the session's file.
void Work::compare_kept_settings(std::vector<Notice>& notices)
{
    SettingValues in_journal, saved;
    try {
        for (RecordNumber number = scan_.records.size(); number > 0 && last_kept_ == 0; --number)
            if (scan_.records[number - 1].kind == RecordKind::kept) last_kept_ = number;
        in_journal = normalized_by(files_.normalized_kept, kept_at(last_kept_));
        saved = normalized_by(files_.normalized_kept, kept_at(known_kept_));
    } catch (const Error& error) {
        last_kept_ = known_kept_ = 0;
        kept_from_outside_ = keeps_settings_;
        notices.push_back({sentence(files_.journal.string(), ": its kept settings cannot be read: ", error.what(),
                                    "; those of the session's file are taken"),
                           true});
        return;
    }
    journaled_kept_ = kept_ = in_journal;
    kept_from_outside_ = keeps_settings_ && known_kept_ == 0;
    std::string changed;
    for (const auto& [name, value] : files_.kept) {
        const auto found = in_journal.find(name);
        const auto was = saved.find(name);
        const bool is_as_saved = known_kept_ != 0 && (was == saved.end() || was->second == value);
        if (found != in_journal.end() && (found->second == value || is_as_saved)) continue;
        kept_[name] = value;
        if (found == in_journal.end()) continue;
        kept_from_outside_ = true;
        changed += (changed.empty() ? "" : ", ") + name;
    }
    if (!changed.empty())
        notices.push_back({sentence(files_.journal.string(), ": these settings of the session were changed since it ",
                                    "was saved: ", changed, "; they are taken")});
}

void Work::append_kept(const SettingValues& values, RecordNumber about)
{
    last_kept_ = journal_->append(RecordKind::kept, {}, bytes_of(values), about);
    kept_since_whole_ = about == 0 ? 0 : kept_since_whole_ + 1;
    if (about == 0) journaled_kept_.clear();
    for (const auto& [name, value] : values) journaled_kept_[name] = value;
}

/// Writes the values that the journal lacks.
void Work::write_kept()
{
    SettingValues differences;
    for (const auto& [name, value] : kept_) {
        const auto held = journaled_kept_.find(name);
        if (held == journaled_kept_.end() || held->second != value) differences[name] = value;
    }
    if (differences.empty()) return;
    if (last_kept_ == 0 || kept_since_whole_ >= MAX_DIFFERENCES)
        append_kept(kept_, 0);
    else
        append_kept(differences, last_kept_);
}

void Work::keep_settings(const SettingValues& values)
{
    keeps_settings_ = true;
    bool differs = false;
    for (const auto& [name, value] : values) {
        std::string& held = kept_[name];
        differs = differs || held != value;
        held = value;
    }
    if (!differs || only_looks_ || is_saving_as_) return;
    if (journal_) return write_kept();
    const bool is_there = !scan_.records.empty() && !is_to_set_aside_;
    // Writes nothing without an undisputed hold: another program may write the journal until a command takes the hold.
    if (!is_there || !hold_ || !hold_->doubtful().empty() || !disputes_.empty() || cannot_keep_) return;
    try {
        open_journal();
    } catch (const Error&) {
        cannot_keep_ = true;
    }
}

}  // namespace shvr
