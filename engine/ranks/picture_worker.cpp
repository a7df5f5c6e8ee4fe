#include "engine/ranks/picture_worker.h"

#include <utility>

#include "engine/ranks/words.h"

namespace shvr {

std::optional<RowStrip> PictureWorker::next()
{
    if (is_ended_) return std::nullopt;
    ranks_.send(0, Ranks::Box::desk, RankWords::WANT);
    while (true) {
        const std::optional<Ranks::Mail> mail = ranks_.take(Ranks::Box::worker, std::chrono::milliseconds(100));
        if (!mail) continue;
        const RankWords words(mail->text);
        if (words.kind() == RankWords::DRAW) return words.strip();
        is_ended_ = true;
        return std::nullopt;
    }
}

bool PictureWorker::is_ended()
{
    // While rows are drawn, the desk has nothing else to say.
    is_ended_ = is_ended_ || ranks_.take(Ranks::Box::worker, std::chrono::milliseconds(0)).has_value();
    return is_ended_;
}

void PictureWorker::send(int64_t lower, ImageF rows)
{
    ranks_.send(0, Ranks::Box::desk, RankWords::rows({lower, lower + rows.height}), std::move(rows.rgba));
}

void PictureWorker::end_done(const std::string& report)
{
    end(RankWords::done(report));
}

void PictureWorker::end_failed(const std::string& why)
{
    end(RankWords::failed(why));
}

void PictureWorker::end(std::string words)
{
    if (!std::exchange(has_said_end_, true)) ranks_.send(0, Ranks::Box::desk, std::move(words));
}

}  // namespace shvr
