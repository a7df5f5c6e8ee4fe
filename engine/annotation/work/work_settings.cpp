// Settings as part of the work: which are believed at opening, and their changes.

#include <utility>

#include "engine/annotation/work/work.h"

namespace shvr {

/// Decides for each setting whether the journal or the session's file is believed.
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

/// A change of the session's file by another program is a step like any other, so it can be undone, too.
void Work::record_settings_from_outside()
{
    if (settings_from_outside_.empty()) return;
    Command command{"settings changed in the session's file", std::exchange(settings_from_outside_, {})};
    const RecordNumber number = record(RecordKind::command, command.label, bytes_of(command.changes));
    history_.perform(document_, std::move(command), number);
    ++unsaved_;
    // Or it would be taken for a change once more after the next one.
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

}  // namespace shvr
