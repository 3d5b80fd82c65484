; THEOREM    13a: dividing integers as (n + (q - 1)) / q rounds up, by less than one.
; ASSUMED    n >= 0 and q > 0 are integers; k is the quotient of n + (q - 1) and q, without the
;            rest.
; CONCLUDED  k q >= n, and (k - 1) q < n.
; SOURCE     own; src/shield.rs, divide_up.
; TWIN       the quotient of n and q.
; SOLVERS    z3 cvc5
(set-info :status unsat)
(set-logic QF_NIA)

; Symbols
(declare-const n Int)         ; dividend
(declare-const q Int)         ; divisor
(declare-const k Int)         ; quotient
(declare-const rest Int)      ; rest
; Assumptions
(assert (>= n 0))
(assert (> q 0))
(assert (= (+ n (- q 1)) (+ (* k q) rest)))
(assert (and (<= 0 rest) (< rest q)))

; Conclusion, negated
(assert (not (and (>= (* k q) n) (< (* (- k 1) q) n))))
(check-sat)
