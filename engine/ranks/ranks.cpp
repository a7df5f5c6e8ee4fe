#include "engine/ranks/ranks.h"

#include <utility>

#include "engine/base/error.h"

namespace shvr {

void Ranks::send(int to, Box box, std::string text, std::vector<float> values)
{
    SHVR_CHECK(to >= 0 && to < count_, to, " of ", count_);
    Mail mail{index_, std::move(text), std::move(values)};
    if (to == index_)
        deliver(box, std::move(mail));
    else
        carry(to, box, std::move(mail));
}

std::optional<Ranks::Mail> Ranks::take(Box box, std::chrono::milliseconds longest)
{
    Inbox& inbox = boxes_[size_t(box)];
    std::unique_lock lock(inbox.mutex);
    if (!inbox.arrived.wait_for(lock, longest, [&] { return !inbox.mails.empty(); })) return std::nullopt;
    Mail mail = std::move(inbox.mails.front());
    inbox.mails.pop_front();
    return mail;
}

void Ranks::deliver(Box box, Mail mail)
{
    Inbox& inbox = boxes_[size_t(box)];
    const std::scoped_lock lock(inbox.mutex);
    inbox.mails.push_back(std::move(mail));
    inbox.arrived.notify_one();
}

void Ranks::set_place(int index, int count)
{
    index_ = index;
    count_ = count;
}

void OneRank::carry(int to, Box, Mail)
{
    SHVR_CHECK(false, "rank ", to);
}

}  // namespace shvr
