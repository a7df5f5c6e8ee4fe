// The spacing of positions in a journal. If the volume gets another spacing, nodes stay at their voxels.

#include "engine/annotation/work/work.h"

namespace shvr {

std::vector<Change> Work::changes_at(RecordNumber number) const
{
    std::vector<Change> changes = changes_of(content_of(number));
    for (Change& change : changes) bring_to_spacing(change, number);
    return changes;
}

/// Converts a change to the present spacing, through each spacing that the journal states after the change's record.
void Work::bring_to_spacing(Change& change, RecordNumber number) const
{
    for (size_t i = 1; i < spaces_.size(); ++i)
        if (number < spaces_[i].since) respace(change, spaces_[i - 1].space.spacing, spaces_[i].space.spacing);
}

/// `at`: on failure, the number of the record that cannot be read.
void Work::read_spaces(RecordNumber& at)
{
    spaces_.clear();
    space_to_note_.reset();
    for (at = 1; at <= scan_.records.size(); ++at)
        if (const RecordKind kind = scan_.records[at - 1].kind;
            kind == RecordKind::space || kind == RecordKind::respaced)
            spaces_.push_back({at, space_of(content_of(at))});
    JournalSpace own{files_.volume.spacing, files_.volume.unit};
    if (!spaces_.empty() && spaces_.back().space == own) return;
    const bool is_same = spaces_.empty() || is_same_spacing(spaces_.back().space.spacing, own.spacing);
    if (is_same && !spaces_.empty() && spaces_.back().space.unit == own.unit) return;
    space_to_note_ = is_same ? RecordKind::space : RecordKind::respaced;
    spaces_.push_back({scan_.records.size() + 1, std::move(own)});
}

/// Reports that the journal has another spacing or unit for the same voxels, and has all saved files rewritten, since
/// they may state the old spacing.
void Work::tell_spacing(std::vector<Notice>& notices)
{
    if (!space_to_note_ || spaces_.size() < 2) return;
    const JournalSpace &before = spaces_[spaces_.size() - 2].space, &now = spaces_.back().space;
    touched_.fill(true);
    misses_files_ = true;
    if (document_.trace.nodes().empty()) return;
    notices.push_back({sentence(files_.journal.string(), ": was traced with voxels of ", in_words(before),
                                "; expected ", in_words(now), ", this volume's: its nodes stay at their voxels, and ",
                                "lengths follow; opening it with the other spacing takes that back")});
}

}  // namespace shvr
