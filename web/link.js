// The connection to web_door. Reconnects when it is lost, but not after a refusal.

const RETRY = 2000; // [ms]
const REFUSED = 1008; // close code of a message that was not allowed

export class Link {
  // take: functions by kind of message (welcome, scene, training, frame, ping, person, refused); say(text): shows a message.
  constructor(take, say) {
    this.take = take;
    this.say = say;
    this.unsent = 0; // frames of hands that were dropped while the previous one was being sent
    this.connect();
  }

  connect() {
    const address = new URL('socket', location.href);
    address.protocol = address.protocol === 'https:' ? 'wss:' : 'ws:';
    this.socket = new WebSocket(address);
    this.socket.onopen = () => {
      this.say('');
      this.take.connected();
    };
    this.socket.onmessage = (event) => {
      const [kind, content] = Object.entries(JSON.parse(event.data))[0];
      if (kind === 'ping') this.tell({pong: [content[0], performance.now()]});
      if (this.take[kind]) this.take[kind](content);
    };
    this.socket.onclose = (event) => {
      this.say(event.reason ? `web_door: ${event.reason}` : 'no connection to web_door');
      if (event.code !== REFUSED) setTimeout(() => this.connect(), RETRY);
    };
  }

  get open() {
    return this.socket.readyState === WebSocket.OPEN;
  }

  tell(content) {
    if (this.open) this.socket.send(JSON.stringify(content));
  }

  // Drops hands while older ones wait: late hands are useless.
  sendHands(data) {
    if (!this.open) return;
    if (this.socket.bufferedAmount > 0) {
      this.unsent += 1;
      return;
    }
    this.socket.send(data);
  }
}
