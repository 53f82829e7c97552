// Which of the two pair buffers a pass of the sort reads and writes: chosen so that the last pass in use writes buffer b, whose values
// are the grid's own memory. Without a pass the emission writes it.
#ifndef PING_PONG_GLSL
#define PING_PONG_GLSL

// `written` counts the passes that have been written when this one is: 0 for the emission, pass + 1 for a pass.
bool writes_a(uint pass_count, uint written) { return ((pass_count - written) & 1u) == 1u; }

#endif
