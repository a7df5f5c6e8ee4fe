// Code shared by the region kernels, with one thread per word. Needs `params` (RegionParams).

uint word_index(uvec3 word)
{
    return word.x + params.words_per_row * (word.y + params.size.y * word.z);
}

bool outside_region(uvec3 word)
{
    return word.x >= params.words_per_row || word.y >= params.size.y || word.z >= params.size.z;
}

// Returns the mask of bits [begin, end) in a word whose first bit has the index `first`.
uint span_bits(int begin, int end, int first)
{
    const int low = clamp(begin - first, 0, 32), high = clamp(end - first, 0, 32);
    if (low >= high) return 0u;
    return (0xffffffffu >> (32 - (high - low))) << low;
}
