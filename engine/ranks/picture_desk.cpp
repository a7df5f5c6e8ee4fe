#include "engine/ranks/picture_desk.h"

#include <algorithm>
#include <utility>

#include "engine/base/error.h"
#include "engine/ranks/words.h"

namespace shvr {

namespace {

constexpr std::chrono::milliseconds PATIENCE{100};

}  // namespace

PictureDesk::PictureDesk(Ranks& ranks, RowPlan plan, const DeskPicture& picture, TakeRows take_rows)
    : ranks_(ranks),
      plan_(std::move(plan)),
      picture_(picture),
      take_rows_(std::move(take_rows)),
      is_ending_worker_(size_t(ranks.count()), false),
      reports_(size_t(ranks.count())),
      thread_([this] { run(); })
{}

PictureDesk::~PictureDesk()
{
    is_ending_ = true;
    if (thread_.joinable()) thread_.join();
}

std::vector<std::string> PictureDesk::finish()
{
    thread_.join();
    if (failure_) std::rethrow_exception(failure_);
    SHVR_CHECK(written_rows_ == picture_.height, written_rows_.load(), " of ", picture_.height);
    return std::move(reports_);
}

void PictureDesk::run()
{
    while (ended_ < ranks_.count()) {
        if (is_ending_) end_all();
        std::optional<Ranks::Mail> mail = ranks_.take(Ranks::Box::desk, PATIENCE);
        if (!mail) continue;
        try {
            handle(std::move(*mail));
            hand_out();
        } catch (const std::exception&) {
            note_failure(std::current_exception());
        }
    }
}

void PictureDesk::handle(Ranks::Mail mail)
{
    const RankWords words(mail.text);
    if (words.kind() == RankWords::WANT) return asking_.push_back(mail.from);
    if (words.kind() == RankWords::ROWS) {
        const RowStrip strip = words.strip();
        return take_rows(strip.lower, {int(picture_.width), int(strip.upper - strip.lower), std::move(mail.values)});
    }
    ++ended_;
    is_ending_worker_[size_t(mail.from)] = true;  // it takes no more mail
    if (words.kind() == RankWords::FAILED) return note_failure(std::make_exception_ptr(Error(words.rest())));
    SHVR_CHECK(words.kind() == RankWords::DONE, mail.text);
    reports_[size_t(mail.from)] = words.rest();
}

/// Passes rows on, or keeps them until those above have arrived.
void PictureDesk::take_rows(int64_t lower, ImageF rows)
{
    SHVR_CHECK(rows.rgba.size() == 4 * size_t(rows.width) * size_t(rows.height), rows.rgba.size());
    waiting_rows_ += rows.height;
    peak_waiting_rows_ = std::max<int64_t>(peak_waiting_rows_, waiting_rows_);
    waiting_.emplace(lower, std::move(rows));
    while (!is_ending_ && !waiting_.empty() && waiting_.begin()->first == written_rows_) {
        ImageF next = std::move(waiting_.begin()->second);
        waiting_.erase(waiting_.begin());
        const int64_t count = next.height;
        take_rows_(std::move(next));
        written_rows_ += count;
        waiting_rows_ -= count;
    }
}

/// Gives their rows to the workers that ask, as far as the window reaches, or tells them that they have no more.
void PictureDesk::hand_out()
{
    for (const int rank : std::exchange(asking_, {})) {
        const std::optional<RowStrip> strip = is_ending_ ? std::nullopt : plan_.peek(rank);
        if (!strip)
            end_worker(rank);
        else if (strip->lower == written_rows_ || strip->upper - written_rows_ <= picture_.window_rows)
            ranks_.send(rank, Ranks::Box::worker, RankWords::draw(*plan_.next(rank)));
        else
            asking_.push_back(rank);
    }
}

void PictureDesk::end_worker(int rank)
{
    if (is_ending_worker_[size_t(rank)]) return;
    is_ending_worker_[size_t(rank)] = true;
    ranks_.send(rank, Ranks::Box::worker, RankWords::END);
}

void PictureDesk::end_all()
{
    for (int rank = 0; rank < ranks_.count(); ++rank) end_worker(rank);
}

void PictureDesk::note_failure(std::exception_ptr failure)
{
    if (!failure_) failure_ = std::move(failure);
    is_ending_ = true;
    waiting_.clear();
}

void end_other_ranks(Ranks& ranks)
{
    for (int rank = 1; rank < ranks.count(); ++rank) ranks.send(rank, Ranks::Box::worker, RankWords::END);
    for (int ended = 1; ended < ranks.count();)
        if (const std::optional<Ranks::Mail> mail = ranks.take(Ranks::Box::desk, PATIENCE))
            ended += RankWords(mail->text).is_last() ? 1 : 0;
}

}  // namespace shvr
