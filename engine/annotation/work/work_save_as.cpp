// Going on under other names, with the whole history.

#include <unistd.h>

#include <utility>

#include "engine/annotation/files/mask_image.h"
#include "engine/annotation/work/work.h"

namespace shvr {

namespace {

namespace fs = std::filesystem;

void expect_free(const WorkFiles& files, const fs::path& session)
{
    const fs::path image = files.mask.empty() ? fs::path() : mask_image_path(files.mask);
    for (const fs::path& path : {session, files.journal, files.mask, image, files.trace, files.density}) {
        std::error_code ignored;
        if (!path.empty() && fs::exists(fs::symlink_status(path, ignored)))
            fail(path.string(), ": exists already; expected a name that is free, since nothing there is replaced");
    }
}

}  // namespace

/// The new files, until the work goes on in them.
class Work::SavingAs {
    /// What was made, in places that were free; removed again unless it is to stay.
    class Made {
    public:
        Made() = default;
        Made(const Made&) = delete;
        ~Made()
        {
            for (const fs::path& path : paths_) {
                std::error_code ignored;
                if (fs::is_directory(path, ignored))
                    fs::remove_all(path, ignored);
                else
                    ::unlink(path.c_str());
            }
        }
        /// Before it is made.
        void add(const fs::path& path) { paths_.push_back(path); }
        void keep() { paths_.clear(); }

    private:
        std::vector<fs::path> paths_;
    };

public:
    /// `before`: of the work as it is; null where it has no history yet.
    SavingAs(const WorkFiles& to, const std::string& program, const Journal* before)
        : hold_(Hold::take(to.journal, program))
    {
        if (before == nullptr) return;
        made.add(to.journal);
        before->copy_to(to.journal);
        journal = std::make_unique<Journal>(to.journal, scan_journal(to.journal));
        journal->append(RecordKind::saving, {}, {});
        journal->flush();
    }

private:
    std::shared_ptr<Hold> hold_;  // let go last

public:
    Made made;
    std::unique_ptr<Journal> journal;
    std::array<Seen, 3> seen;
    SavedFiles known;
    std::shared_ptr<Hold> keep()
    {
        made.keep();
        return std::move(hold_);
    }
};

Work::Saved Work::save_as(const WorkFiles& to, const std::vector<LabelImage::Color>& looks, const fs::path& session,
                          const std::function<void()>& save_session)
{
    SHVR_CHECK(!is_saving_, "a save is under way");
    refuse_if_only_looking();
    expect_choice();
    expect_names(to);
    expect_free(to, session);
    const bool has_history = journal_ || (!scan_.records.empty() && !is_to_set_aside_);
    if (has_history) {
        begin_journal();
        journal_->flush();
    }
    SavingAs next(to, program_, has_history ? journal_.get() : nullptr);
    next.known.settings = save_session ? document_.settings.values() : known_.settings;
    Saved saved;
    for (const Part part : PARTS) {
        const fs::path& file = file_of(to, part);
        if (file.empty() || (part != Part::mask && !holds_any(document_, part))) continue;
        next.made.add(file);
        if (part == Part::mask) next.made.add(mask_image_path(file));
        write(part, document_, to, looks, next.journal.get());
        next.seen[size_t(part)] = seen_at(file);
        digest_of(next.known, part) = next.seen[size_t(part)].digest;
        saved.files.push_back(file);
    }
    const RecordNumber known_kept = !save_session ? known_kept_ : keeps_settings_ ? last_kept_ : 0;
    if (next.journal) {
        next.journal->append(RecordKind::saved, {}, bytes_of(next.known), known_kept);
        next.journal->flush();
    }
    if (save_session) {
        if (!session.empty()) next.made.add(session);
        save_session();
    }

    // From here on nothing can fail.
    journal_ = std::move(next.journal);
    hold_ = next.keep();
    if (!has_history) scan_ = {};
    scanned_.reset();
    is_to_set_aside_ = is_fresh_ = cannot_keep_ = false;
    const WorkFiles before = std::exchange(files_, to);
    files_.settings = save_session ? document_.settings.values() : before.settings;
    files_.kept = save_session && keeps_settings_ ? kept_ : before.kept;
    files_.normalized = before.normalized;
    files_.normalized_kept = before.normalized_kept;
    known_ = std::move(next.known);
    known_kept_ = known_kept;
    seen_ = next.seen;
    unsaved_ = 0;
    misses_files_ = false;
    touched_ = {};
    return saved;
}

}  // namespace shvr
