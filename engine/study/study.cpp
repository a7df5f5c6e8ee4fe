#include "engine/study/study.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <set>

#include "engine/annotation/files/mask_file.h"
#include "engine/annotation/measures/trace_score.h"
#include "engine/annotation/trace/trace_file.h"
#include "engine/base/atomic_file.h"
#include "engine/base/error.h"
#include "engine/base/file.h"
#include "engine/base/machine/machine.h"
#include "engine/base/text.h"
#include "engine/base/waits/work_pool.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

constexpr double NO_SCORE = std::numeric_limits<double>::quiet_NaN();

/// Returns the start of a CSV file's name: "rows", or "hand-" with trait and factor if the item varies the hand.
std::string file_stem(const StudyItem& item)
{
    if (item.trait >= hand_traits().size()) return "rows";
    return sentence("hand-", hand_traits()[item.trait].name, "-", digits_of(item.factor));
}

/// In the study's folder.
fs::path annotation_path(const StudyItem& item)
{
    const StudyCondition& c = item.condition;
    return fs::path("annotations") / sentence(item.trait < hand_traits().size() ? file_stem(item) + "-" : "",
                                              spelled(c.task), "-", spelled(c.touch), "-", spelled(c.law), "-",
                                              digits_of(c.probe_radii), "-", digits_of(c.noise), "-seed-", item.seed,
                                              "-annotator-", item.annotator,
                                              c.task == StudyTask::trace ? ".graphml" : ".mask");
}

void save_annotation(const fs::path& path, const StudyScene& scene, const StudyAnnotation& made)
{
    if (made.row.condition.task == StudyTask::trace)
        save_trace(path, made.trace, space_of(scene.volume().info()));
    else
        save_mask(path, made.mask);
}

bool is_row_of(const StudyItem& item, const StudyRow& row)
{
    return row.condition == item.condition && row.annotator == item.annotator && row.seed == item.seed;
}

bool is_repeat_of(const StudyPair& pair, const StudyRepeat& repeat)
{
    return repeat.condition == pair.condition && repeat.annotator == pair.annotator && repeat.other == pair.other &&
           repeat.seed == pair.seed;
}

std::set<size_t> found_segments(const StudyScene& scene, const TraceGraph& trace)
{
    std::set<size_t> found;
    for (size_t i = 0; i < scene.segments().size(); ++i) {
        TraceGraph alone;
        const TraceSegment& segment = scene.segments()[i];
        for (const uint32_t node : segment.nodes)
            alone.apply(TraceNodeChange{node, {}, scene.trace().node(node)}, Direction::forwards);
        for (const uint32_t internode : segment.internodes)
            alone.apply(TraceInternodeChange{internode, {}, scene.trace().internode(internode)}, Direction::forwards);
        if (compare(trace, alone, 1.0).segments_found == 1) found.insert(i);
    }
    return found;
}

StudyRepeat repeat_of(const StudyScene& scene, const StudyPair& pair)
{
    StudyRepeat repeat{.condition = pair.condition,
                       .annotator = pair.annotator,
                       .other = pair.other,
                       .seed = pair.seed,
                       .dice = NO_SCORE,
                       .segment_agreement = NO_SCORE,
                       .distance_rms = NO_SCORE};
    const uint32_t attempt = pair.annotator == pair.other ? 1 : 0;
    const StudyAnnotation a = annotate(scene, pair.condition, pair.annotator, pair.seed);
    const StudyAnnotation b = annotate(scene, pair.condition, pair.other, pair.seed, {}, attempt);
    if (pair.condition.task == StudyTask::paint) {
        repeat.dice = dice_of(a.mask, b.mask).painted.value_or(NO_SCORE);
        return repeat;
    }
    const std::set<size_t> in_a = found_segments(scene, a.trace), in_b = found_segments(scene, b.trace);
    const auto both = std::ranges::count_if(in_a, [&](size_t segment) { return in_b.contains(segment); });
    const auto either = std::ptrdiff_t(in_a.size() + in_b.size()) - both;
    if (either > 0) repeat.segment_agreement = double(both) / double(either);
    const std::optional<double> there = compare(a.trace, b.trace, 1.0).centreline_rms,
                                back = compare(b.trace, a.trace, 1.0).centreline_rms;
    if (there && back) repeat.distance_rms = std::sqrt(0.5 * (*there * *there + *back * *back));
    return repeat;
}

/// The items and pairs of one phantom.
struct Piece {
    SceneSpec scene;
    std::vector<size_t> items, pairs;
};

class Study {
public:
    Study(const StudyPlan& plan, const StudyRun& run) : plan_(plan), run_(run), rows_(plan.items.size())
    {
        repeats_.resize(plan.pairs.size());
        check_folder();
        read_rows();
        cut();
    }

    StudyResults make()
    {
        WorkPool pool(run_.threads > 0 ? run_.threads : processors_allowed(),
                      [&] { tell(run_.progress, share_done()); });
        pool.run(int64_t(pieces_.size()), [&](int64_t piece, int) { make(pieces_[size_t(piece)]); });
        if (run_.of == 1) write_rows();  // also if parts have made all of them
        return results();
    }

private:
    fs::path note_path() const { return run_.folder / "phantoms.txt"; }
    std::string note() const { return sentence("side ", plan_.side, "\n"); }

    void check_folder() const
    {
        for (const fs::path& folder : {run_.folder, run_.folder / "annotations"}) {
            if (folder != run_.folder && !run_.keeps_annotations) continue;
            std::error_code error;
            fs::create_directories(folder, error);
            if (error) fail(folder.string(), ": cannot be created: ", error.message());
        }
        if (!fs::exists(note_path())) {
            const std::string text = note();
            write_file_atomically(note_path(), std::as_bytes(std::span(text)));
            return;
        }
        const std::string found = read_text(note_path(), 1000);
        if (found != note())
            fail(note_path().string(), ": holds ", in_quotes(found.substr(0, found.find('\n'))), "; expected ",
                 in_quotes(note().substr(0, note().size() - 1)), ", as this study's phantoms; choose another folder");
    }

    /// Reads rows and repeats that an earlier run or another part has already written.
    void read_rows()
    {
        for (const fs::directory_entry& entry : fs::directory_iterator(run_.folder)) {
            const std::string name = entry.path().filename().string();
            if (entry.path().extension() == ".csv" && name.starts_with("repeats")) read_repeats(entry.path());
            if (entry.path().extension() != ".csv" || (!name.starts_with("rows") && !name.starts_with("hand-")))
                continue;
            const std::vector<StudyRow> rows = read_study_rows(entry.path());
            for (size_t i = 0; i < plan_.items.size(); ++i) {
                if (run_.keeps_annotations && !fs::exists(run_.folder / annotation_path(plan_.items[i]))) continue;
                const std::string stem = file_stem(plan_.items[i]);
                if (name != stem + ".csv" && !name.starts_with(stem + "-part-")) continue;
                for (const StudyRow& row : rows)
                    if (is_row_of(plan_.items[i], row)) {
                        rows_[i] = row;
                        if (name == stem + suffix() + ".csv") own_items_.insert(i);
                    }
            }
            keep_others(name, rows);
        }
    }

    /// Keeps the rows of a file that are not of this plan, such as those of more seeds, for the file is written again.
    void keep_others(const std::string& name, const std::vector<StudyRow>& rows)
    {
        for (const StudyRow& row : rows) {
            const bool is_planned = std::ranges::any_of(plan_.items, [&](const StudyItem& item) {
                return name == file_stem(item) + suffix() + ".csv" && is_row_of(item, row);
            });
            if (!is_planned) other_rows_[name].push_back(row);
        }
    }

    void read_repeats(const fs::path& file)
    {
        const std::vector<StudyRepeat> repeats = read_study_repeats(file);
        for (size_t i = 0; i < plan_.pairs.size(); ++i)
            for (const StudyRepeat& repeat : repeats)
                if (is_repeat_of(plan_.pairs[i], repeat)) {
                    repeats_[i] = repeat;
                    if (file.filename() == "repeats" + suffix() + ".csv") own_pairs_.insert(i);
                }
        if (file.filename() != "repeats" + suffix() + ".csv") return;
        for (const StudyRepeat& repeat : repeats)
            if (std::ranges::none_of(plan_.pairs, [&](const StudyPair& pair) { return is_repeat_of(pair, repeat); }))
                other_repeats_.push_back(repeat);
    }

    /// Groups the unfinished items of the plan into pieces, one per phantom, and keeps the pieces of this part.
    void cut()
    {
        std::map<std::pair<uint32_t, double>, Piece> pieces;
        const auto piece_of = [&](uint32_t seed, double noise) -> Piece& {
            Piece& piece = pieces[{seed, noise}];
            piece.scene = {plan_.side, seed, noise};
            return piece;
        };
        for (size_t i = 0; i < plan_.items.size(); ++i)
            piece_of(plan_.items[i].seed, plan_.items[i].condition.noise).items.push_back(i);
        for (size_t i = 0; i < plan_.pairs.size(); ++i)
            piece_of(plan_.pairs[i].seed, plan_.pairs[i].condition.noise).pairs.push_back(i);
        int64_t number = 0;
        for (auto& [key, piece] : pieces) {
            if (number++ % run_.of != run_.part) continue;
            std::erase_if(piece.items, [&](size_t item) { return rows_[item].has_value(); });
            std::erase_if(piece.pairs, [&](size_t pair) { return repeats_[pair].has_value(); });
            if (!piece.items.empty() || !piece.pairs.empty()) pieces_.push_back(std::move(piece));
        }
        for (const Piece& piece : pieces_) to_make_ += piece.items.size() + piece.pairs.size();
    }

    double share_done()
    {
        const std::lock_guard lock(mutex_);
        return to_make_ > 0 ? double(made_ + made_pairs_) / double(to_make_) : 1.0;
    }

    void make(const Piece& piece)
    {
        const StudyScene scene(piece.scene);
        for (const size_t i : piece.items) {
            const StudyItem& item = plan_.items[i];
            HandTraits traits;
            if (item.trait < hand_traits().size()) traits.*hand_traits()[item.trait].value *= item.factor;
            const StudyAnnotation made = annotate(scene, item.condition, item.annotator, item.seed, traits);
            if (run_.keeps_annotations) save_annotation(run_.folder / annotation_path(item), scene, made);
            const std::lock_guard lock(mutex_);
            rows_[i] = made.row;
            own_items_.insert(i);
            ++made_;
        }
        for (const size_t i : piece.pairs) {
            const StudyRepeat repeat = repeat_of(scene, plan_.pairs[i]);
            const std::lock_guard lock(mutex_);
            repeats_[i] = repeat;
            own_pairs_.insert(i);
            ++made_pairs_;
        }
        const std::lock_guard lock(mutex_);
        write_rows();
    }

    /// In the names of the files of a part.
    std::string suffix() const { return run_.of == 1 ? "" : sentence("-part-", run_.part, "-of-", run_.of); }

    /// Writes all files in the order of the plan, and then the rows that they had beyond it. A part writes only the
    /// rows that it made itself, in this run or an earlier one, into its own files.
    void write_rows() const
    {
        std::map<std::string, std::vector<StudyRow>> files;
        for (size_t i = 0; i < rows_.size(); ++i)
            if (rows_[i] && (run_.of == 1 || own_items_.contains(i)))
                files[file_stem(plan_.items[i])].push_back(*rows_[i]);
        const std::string part = suffix();
        for (auto& [stem, rows] : files) {
            if (const auto others = other_rows_.find(stem + part + ".csv"); others != other_rows_.end())
                rows.insert(rows.end(), others->second.begin(), others->second.end());
            const std::string csv = csv_of(rows);
            write_file_atomically(run_.folder / (stem + part + ".csv"), std::as_bytes(std::span(csv)));
        }
        std::vector<StudyRepeat> repeats;
        for (size_t i = 0; i < repeats_.size(); ++i)
            if (repeats_[i] && (run_.of == 1 || own_pairs_.contains(i))) repeats.push_back(*repeats_[i]);
        if (repeats.empty()) return;
        repeats.insert(repeats.end(), other_repeats_.begin(), other_repeats_.end());
        const std::string csv = csv_of(repeats);
        write_file_atomically(run_.folder / ("repeats" + part + ".csv"), std::as_bytes(std::span(csv)));
    }

    StudyResults results() const
    {
        StudyResults results;
        std::map<std::pair<size_t, double>, std::vector<StudyRow>> varied;
        for (size_t i = 0; i < rows_.size(); ++i) {
            const StudyItem& item = plan_.items[i];
            if (!rows_[i]) {
                ++results.missing;
            } else if (item.trait < hand_traits().size()) {
                varied[{item.trait, item.factor}].push_back(*rows_[i]);
            } else {
                results.rows.push_back(*rows_[i]);
            }
        }
        for (auto& [key, rows] : varied) results.variations.push_back({key.first, key.second, std::move(rows)});
        for (const std::optional<StudyRepeat>& repeat : repeats_) {
            if (repeat) results.repeats.push_back(*repeat);
            results.missing += !repeat;
        }
        results.made_here = made_;
        return results;
    }

    const StudyPlan& plan_;
    const StudyRun& run_;
    std::vector<std::optional<StudyRow>> rows_;  ///< of plan_.items
    std::vector<std::optional<StudyRepeat>> repeats_;
    std::set<size_t> own_items_, own_pairs_;                   ///< those that this part made
    std::map<std::string, std::vector<StudyRow>> other_rows_;  ///< not of the plan, by the name of their file
    std::vector<StudyRepeat> other_repeats_;                   ///< not of the plan, in the file that this part writes
    std::vector<Piece> pieces_;
    size_t to_make_ = 0, made_ = 0, made_pairs_ = 0;  ///< by this run
    std::mutex mutex_;
};

}  // namespace

StudyResults run_study(const StudyPlan& plan, const StudyRun& run)
{
    return Study(plan, run).make();
}

}  // namespace shvr
