"""Threads that share a job: they take its pieces, one after the other, until none is left.

    first:   a queue of pieces for each thread,   round += 1,   pieces,   until done == pieces
    others:  until round has changed,   pieces

A thread takes the pieces of its own queue, which lie near each other in memory, and then those
left in those of others: one that the machine holds up, or that sleeps, costs no more than the piece
it has begun. The thread that does a piece has no effect on its result, and sums of several
pieces are taken by the first alone, in the order of the pieces (model/partition.py). Consequence to
test: the same bits for any number of threads, and however they are held up.

A queue is one word: the round, the next piece, and the end. So a thread that takes a piece has
that it is of the present round.
"""

from crashsolve.foundation.atomic import (
    add_release,
    load_acquire,
    offer_processor,
    replaced,
    sleep,
    store_release,
)
from crashsolve.foundation.kernels import kernel

# indices in `queues`, as far apart as cache lines: round, pieces done, queues of the threads
ROUND, DONE, QUEUES, LINE = 0, 8, 16, 8
# the round in which the threads end
LAST_ROUND = -1
# parts of the word of a queue
NEXT, OF_ROUND = 2**16, 2**32
MAX_PIECES = NEXT - 1
# polls, some 20 microseconds, before the core is offered to others, and before the thread sleeps
SPINS, YIELDS = 4000, 500
SLEEP_TIME = 100  # microseconds


@kernel
def call(pieces, threads, queues):
    """Start a round of so many pieces for all threads; returns its number. Writes: queues."""
    number = queues[ROUND] + 1
    queues[DONE] = 0
    for k in range(threads):
        begin, end = pieces * k // threads, pieces * (k + 1) // threads
        store_release(queues, QUEUES + LINE * k, number * OF_ROUND + begin * NEXT + end)
    store_release(queues, ROUND, number)
    return number


@kernel
def next_piece(me, number, threads, queues):
    """Claim a piece of this round that no thread has begun; -1 without one. Writes: queues."""
    for k in range(threads):
        piece = claim(QUEUES + LINE * ((me + k) % threads), number, queues)
        if piece >= 0:
            return piece
    return -1


@kernel
def claim(queue, number, queues):
    """Claim the next piece of a queue; -1 where it is empty. Writes: queues."""
    while True:
        word = load_acquire(queues, queue)
        piece, end = word // NEXT % NEXT, word % NEXT
        if word // OF_ROUND != number or piece == end:
            return -1
        if replaced(queues, queue, word, word + NEXT):
            return piece


@kernel
def finish(queues):
    """Count a piece as done. Writes: queues."""
    add_release(queues, DONE, 1)


@kernel
def wait_for_all(pieces, queues):
    """Wait until all pieces are done."""
    done, polls = load_acquire(queues, DONE), 0
    while done < pieces:
        polls = back_off(polls)
        done = load_acquire(queues, DONE)


@kernel
def wait_for_call(number, queues):
    """Wait until there is another round; returns its number."""
    now, polls = load_acquire(queues, ROUND), 0
    while now == number:
        polls = back_off(polls)
        now = load_acquire(queues, ROUND)
    return now


@kernel
def back_off(polls):
    """Wait before the next poll, the longer the more there were; returns their number."""
    if polls > SPINS + YIELDS:
        sleep(SLEEP_TIME)
        return polls
    if polls > SPINS:
        offer_processor()
    return polls + 1
