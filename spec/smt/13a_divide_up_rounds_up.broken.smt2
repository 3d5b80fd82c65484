; BROKEN     Twin of 13a_divide_up_rounds_up.smt2: the quotient of n and q.
(set-info :status sat)
(set-logic QF_NIA)

; Symbols
(declare-const n Int)         ; dividend
(declare-const q Int)         ; divisor
(declare-const k Int)         ; quotient
(declare-const rest Int)      ; rest
; Assumptions
(assert (>= n 0))
(assert (> q 0))
(assert (= n (+ (* k q) rest)))                              ; BROKEN: q - 1 is missing
(assert (and (<= 0 rest) (< rest q)))

; Conclusion, negated
(assert (not (and (>= (* k q) n) (< (* (- k 1) q) n))))
(check-sat)
