using System.Threading;

namespace Palpate
{
    /// <summary>
    /// Latest value from one thread to another: three buffers, of which the writer has one, the
    /// reader one, and the third changes hands. Neither waits, locks or allocates.
    /// </summary>
    public sealed class Exchange<T> where T : class, new()
    {
        private const int Fresh = 4;
        private readonly T[] buffers = { new T(), new T(), new T() };
        private int back = 0, middle = 1, front = 2;

        /// <summary>Writer: what Publish() will hand over. It holds an older value.</summary>
        public T Back { get { return buffers[back]; } }

        /// <summary>Writer: Back becomes the latest value.</summary>
        public void Publish() { back = Interlocked.Exchange(ref middle, back | Fresh) & ~Fresh; }

        /// <summary>Reader: the latest value. The reader alone has it until the next call.
        /// </summary>
        public T Latest()
        {
            if ((Volatile.Read(ref middle) & Fresh) != 0)
            {
                front = Interlocked.Exchange(ref middle, front) & ~Fresh;
            }
            return buffers[front];
        }
    }
}
