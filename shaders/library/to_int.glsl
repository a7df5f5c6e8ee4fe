// Numbers of a magnitude below 2^22 to integers, toward zero, as int(number) and uint(number) convert them. llvmpipe of
// Mesa 23.3 and later does those lane by lane, since results beyond an integer's range are defined there; sums and bits
// are all lanes' at once (MEASURED.md).
#ifndef SHVR_TO_INT_GLSL
#define SHVR_TO_INT_GLSL

// 1.5 times 2^23: between 2^23 and 2^24 the bits of a float count up with it.
const float COUNTING_FROM = 12582912.0;
const int BITS_FROM = 0x4b400000;

ivec3 int_of_whole(vec3 whole)
{
    return floatBitsToInt(whole + COUNTING_FROM) - BITS_FROM;
}

uint to_uint(float number)
{
    return uint(floatBitsToInt(trunc(number) + COUNTING_FROM) - BITS_FROM);
}

ivec3 to_int(vec3 numbers)
{
    return int_of_whole(trunc(numbers));
}

uvec3 to_uint(vec3 numbers)
{
    return uvec3(to_int(numbers));
}

#endif
