#pragma once
// An ordered map from numbers to values, with copy-on-write pages of 256 consecutive numbers. Copying costs only the
// table of pages; before a page that another copy may share is changed, it is duplicated.
//
// A mark, not a reference count, decides whether a page may be changed in place: copying gives both maps new marks, so
// neither changes a page that was shared before. One thread changes a map; other threads may read, copy and destroy
// copies.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <map>
#include <memory>
#include <utility>
#include <vector>

namespace shvr {

template <class Value>
class SharedMap {
public:
    using Entry = std::pair<uint32_t, Value>;

private:
    static constexpr uint32_t PAGE_NUMBERS = 256;
    struct Page {
        uint64_t mark = 0;           ///< mark of the map that may change this page in place
        std::vector<Entry> entries;  ///< ascending, never empty
    };
    using Pages = std::map<uint32_t, std::shared_ptr<const Page>>;  ///< by number / PAGE_NUMBERS

public:
    class Iterator {
    public:
        using iterator_category = std::bidirectional_iterator_tag;
        using value_type = Entry;
        using difference_type = std::ptrdiff_t;
        using pointer = const Entry*;
        using reference = const Entry&;

        Iterator() = default;
        reference operator*() const { return page_->second->entries[index_]; }
        pointer operator->() const { return &**this; }
        Iterator& operator++()
        {
            if (++index_ == page_->second->entries.size()) {
                ++page_;
                index_ = 0;
            }
            return *this;
        }
        Iterator operator++(int)
        {
            const Iterator before = *this;
            ++*this;
            return before;
        }
        Iterator& operator--()
        {
            if (index_ == 0) {
                --page_;
                index_ = page_->second->entries.size();
            }
            --index_;
            return *this;
        }
        bool operator==(const Iterator& other) const { return page_ == other.page_ && index_ == other.index_; }

    private:
        friend class SharedMap;
        Iterator(typename Pages::const_iterator page, size_t index) : page_(page), index_(index) {}
        typename Pages::const_iterator page_{};
        size_t index_ = 0;
    };
    using const_iterator = Iterator;

    SharedMap() = default;
    SharedMap(const SharedMap& other) : pages_(other.pages_), size_(other.size_) { other.mark_ = next_mark(); }
    SharedMap& operator=(const SharedMap& other)
    {
        if (this == &other) return *this;
        pages_ = other.pages_;
        size_ = other.size_;
        mark_ = next_mark();
        other.mark_ = next_mark();
        return *this;
    }
    SharedMap(SharedMap&& other) noexcept
        : pages_(std::exchange(other.pages_, {})), size_(std::exchange(other.size_, 0)), mark_(other.mark_.load())
    {
        other.mark_ = next_mark();
    }
    SharedMap& operator=(SharedMap&& other) noexcept
    {
        if (this == &other) return *this;
        pages_ = std::exchange(other.pages_, {});
        size_ = std::exchange(other.size_, 0);
        mark_ = other.mark_.load();
        other.mark_ = next_mark();
        return *this;
    }

    Iterator begin() const { return {pages_.begin(), 0}; }
    Iterator end() const { return {pages_.end(), 0}; }
    size_t size() const { return size_; }
    bool empty() const { return size_ == 0; }
    Iterator find(uint32_t number) const
    {
        const auto page = pages_.find(number / PAGE_NUMBERS);
        if (page == pages_.end()) return end();
        const size_t index = place_in(page->second->entries, number);
        const bool is_there = index < page->second->entries.size() && page->second->entries[index].first == number;
        return is_there ? Iterator(page, index) : end();
    }
    bool contains(uint32_t number) const { return find(number) != end(); }

    /// Mutable access to the value of a number, which is created if missing. Valid until the map changes or is copied.
    Value& operator[](uint32_t number)
    {
        Page& page = own(number / PAGE_NUMBERS);
        const size_t index = place_in(page.entries, number);
        if (index == page.entries.size() || page.entries[index].first != number) {
            page.entries.insert(page.entries.begin() + std::ptrdiff_t(index), Entry(number, Value()));
            ++size_;
        }
        return page.entries[index].second;
    }
    void erase(uint32_t number)
    {
        if (!contains(number)) return;
        Page& page = own(number / PAGE_NUMBERS);
        page.entries.erase(page.entries.begin() + std::ptrdiff_t(place_in(page.entries, number)));
        --size_;
        if (page.entries.empty()) pages_.erase(number / PAGE_NUMBERS);
    }
    friend bool operator==(const SharedMap& left, const SharedMap& right)
    {
        return left.size_ == right.size_ && std::equal(left.begin(), left.end(), right.begin());
    }

private:
    static uint64_t next_mark()
    {
        static std::atomic<uint64_t> last = 0;
        return ++last;
    }
    static size_t place_in(const std::vector<Entry>& entries, uint32_t number)
    {
        const auto found = std::lower_bound(entries.begin(), entries.end(), number,
                                            [](const Entry& entry, uint32_t wanted) { return entry.first < wanted; });
        return size_t(found - entries.begin());
    }
    /// Returns a page that no other copy shares, duplicating or creating it if necessary.
    Page& own(uint32_t index)
    {
        std::shared_ptr<const Page>& held = pages_[index];
        if (!held || held->mark != mark_) {
            auto page = std::make_shared<Page>();
            page->mark = mark_;
            if (held) page->entries = held->entries;
            held = std::move(page);
        }
        return const_cast<Page&>(*held);  // safe: created above, and not shared since
    }

    Pages pages_;
    size_t size_ = 0;
    mutable std::atomic<uint64_t> mark_ = next_mark();
};

}  // namespace shvr
