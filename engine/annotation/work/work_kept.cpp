// Kept settings, which come back as they were left and are no steps: which are believed at opening, and how they are
// written.

#include <utility>

#include "engine/annotation/work/work.h"

namespace shvr {

namespace {

/// After so many records with differences one with all sections is written, so that opening reads few of them.
constexpr size_t MAX_DIFFERENCES = 256;

SettingValues normalized_by(const std::function<SettingValues(const SettingValues&)>& normalized,
                            const SettingValues& values)
{
    return normalized ? normalized(values) : values;
}

}  // namespace

/// As of a `kept` record: each names the one before, down to one that holds all sections.
SettingValues Work::kept_at(RecordNumber number) const
{
    SettingValues values;
    while (number != 0) {
        if (number > scan_.records.size() || scan_.records[number - 1].kind != RecordKind::kept)
            fail("record ", number, " holds no kept settings");
        for (auto& [name, value] : setting_values_of(content_of(number)))
            values.try_emplace(name, std::move(value));  // the newest comes first
        const RecordNumber before = scan_.records[number - 1].about;
        if (before >= number) fail("record ", number, " continues record ", before, " behind it");
        number = before;
    }
    return values;
}

/// Decides for each section whether the journal or the session's file is believed.
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

/// What the journal does not hold yet.
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
    if (!differs || only_looks_) return;
    if (journal_) return write_kept();
    const bool is_there = !scan_.records.empty() && !is_to_set_aside_;
    // Without a hold another program may write the journal, until a command takes it.
    if (!is_there || !hold_ || !disputes_.empty() || cannot_keep_) return;
    try {
        open_journal();
    } catch (const Error&) {
        cannot_keep_ = true;
    }
}

}  // namespace shvr
