// Continues the work under other names, together with its whole history.

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

/// Owns files created at free paths; removes them in its destructor unless `keep` was called.
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
    /// Call this before the file is created.
    void add(const fs::path& path) { paths_.push_back(path); }
    void keep() { paths_.clear(); }

private:
    std::vector<fs::path> paths_;
};

}  // namespace

std::unique_ptr<Work::SavingAs> Work::begin_save_as(const WorkFiles& to, std::vector<LabelImage::Color> looks,
                                                    const fs::path& session)
{
    SHVR_CHECK(!is_saving_, "a save is under way");
    refuse_if_only_looking();
    expect_choice();
    expect_names(to);
    expect_free(to, session);
    const bool has_history = journal_ || (!scan_.records.empty() && !is_to_set_aside_);
    if (has_history) begin_journal();
    std::unique_ptr<SavingAs> saving(new SavingAs);
    saving->files_ = to;
    saving->files_.mask_before = mask_of_header();
    saving->document_ = document_;
    saving->looks_ = std::move(looks);
    saving->session_ = session;
    saving->program_ = program_;
    if (has_history) saving->before_ = journal_;
    saving->known_.settings = known_.settings;
    saving->kept_ = kept_;
    saving->last_kept_ = keeps_settings_ ? last_kept_ : 0;
    saving->known_kept_ = known_kept_;
    is_saving_ = is_saving_as_ = true;
    return saving;
}

void Work::SavingAs::write(const std::function<void()>& save_session, const Progress& progress)
{
    SHVR_CHECK(!is_written_, "a save is written once");
    int error = 0;
    std::shared_ptr<Hold> hold = Hold::take(files_.journal, program_, error);  // released last
    if (before_ && !hold) fail(files_.journal.string(), ": cannot be written: ", reason_of(error));
    if (hold && !hold->doubtful().empty())
        throw JournalTaken(sentence(files_.journal.string(), ": is open for writing in ",
                                    in_words(hold->doubtful().front()), "; expected this name to be free"));
    expect_free(files_, session_);  // checked again
    Made made;
    constexpr double SHARE = 1.0 / double(PARTS.size() + 2);
    double done = 0.0;
    const auto tell_step = [&] { tell(progress, std::exchange(done, done + SHARE)); };
    tell_step();
    std::unique_ptr<Journal> journal;
    if (before_) {
        before_->flush();
        made.add(files_.journal);
        before_->copy_to(files_.journal);
        journal = std::make_unique<Journal>(files_.journal, scan_journal(files_.journal), hold);
        journal->append(RecordKind::saving, {}, {});
        journal->flush();
    }
    if (save_session) {
        known_.settings = document_.settings.values();
        known_kept_ = last_kept_;
    }
    for (const Part part : PARTS) {
        tell_step();
        const fs::path& file = file_of(files_, part);
        if (file.empty() || (part != Part::mask && !holds_any(document_, part))) continue;
        made.add(file);
        if (part == Part::mask) made.add(mask_image_path(file));
        Work::write(part, document_, files_, looks_, journal.get(), part_of(progress, done - SHARE, done));
        seen_[size_t(part)] = seen_at(file);
        digest_of(known_, part) = seen_[size_t(part)].digest;
        saved_.files.push_back(file);
    }
    tell_step();
    if (journal) {
        journal->append(RecordKind::saved, {}, bytes_of(known_), known_kept_);
        journal->flush();
    }
    if (save_session) {
        if (!session_.empty()) made.add(session_);
        save_session();
    }

    // From here on nothing can fail.
    made.keep();
    hold_ = std::move(hold);
    journal_ = std::move(journal);
    has_session_ = bool(save_session);
    is_written_ = true;
}

Work::Saved Work::end_save_as(SavingAs& saving)
{
    SHVR_CHECK(is_saving_as_, "no save under another name has begun");
    is_saving_ = is_saving_as_ = false;
    const bool has_history = saving.before_ != nullptr;
    saving.before_.reset();  // the old journal may be reopened before `saving` is destroyed
    if (!saving.is_written_) {
        if (journal_) write_kept();
        return saving.saved_;
    }
    journal_ = std::move(saving.journal_);
    hold_ = std::move(saving.hold_);
    if (!has_history) scan_ = {};
    scanned_.reset();
    is_to_set_aside_ = is_fresh_ = cannot_keep_ = false;
    const WorkFiles before = std::exchange(files_, saving.files_);
    files_.settings = saving.has_session_ ? saving.document_.settings.values() : before.settings;
    files_.kept = saving.has_session_ && keeps_settings_ ? saving.kept_ : before.kept;
    files_.mask_before.clear();
    files_.normalized = before.normalized;
    files_.normalized_kept = before.normalized_kept;
    known_ = std::move(saving.known_);
    known_kept_ = saving.known_kept_;
    seen_ = saving.seen_;
    unsaved_ = 0;
    misses_files_ = false;
    touched_ = {};
    if (journal_) write_kept();
    return std::move(saving.saved_);
}

Work::Saved Work::save_as(const WorkFiles& to, std::vector<LabelImage::Color> looks, const fs::path& session,
                          const std::function<void()>& save_session)
{
    const std::unique_ptr<SavingAs> saving = begin_save_as(to, std::move(looks), session);
    try {
        saving->write(save_session);
    } catch (...) {
        end_save_as(*saving);
        throw;
    }
    return end_save_as(*saving);
}

}  // namespace shvr
